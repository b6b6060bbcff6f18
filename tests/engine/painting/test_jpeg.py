import io

import numpy as np
from PIL import Image

from culet.engine.painting import jpeg

# A saturated red and blue checker of single pixels: what chroma subsampling would turn to purple.
CHECKER = np.zeros((32, 32, 3), np.uint8)
CHECKER[..., 0] = 255 * (np.indices((32, 32)).sum(axis=0) % 2)
CHECKER[..., 2] = 255 - CHECKER[..., 0]


def decoded(data: bytes) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float)


def test_fine_saturated_colour_survives() -> None:
    error = np.abs(decoded(jpeg.encode(CHECKER, moving=True)) - CHECKER).mean()
    assert error < 5  # measured 2.4; with 4:2:0 it is 89


def test_a_picture_at_rest_is_closer_to_the_truth() -> None:
    rng = np.random.default_rng(1)
    noise = rng.integers(0, 256, (64, 64, 3), dtype=np.uint8)
    moving, resting = (np.abs(decoded(jpeg.encode(noise, moving=m)) - noise).mean() for m in (True, False))
    assert resting < 0.75 * moving  # measured 0.55


def test_a_view_that_is_not_contiguous_is_encoded_as_what_it_shows() -> None:
    flipped = jpeg.encode(CHECKER[:, ::-1], moving=False)
    assert flipped == jpeg.encode(np.ascontiguousarray(CHECKER[:, ::-1]), moving=False)
