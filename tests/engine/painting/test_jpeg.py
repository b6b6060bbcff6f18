import io
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from culet.engine.governing.thrift import ByteAllowance, Encoding
from culet.engine.painting import jpeg
from culet.engine.painting.coded import Coded
from culet.engine.painting.quality import Quality
from culet.rendering.renderer import Renderer
from culet.scene.presets import preset
from culet.study.stream.falling_frames import falling
from culet_protocol.messages import Balance

# A saturated red and blue checker of single pixels: what chroma subsampling would turn to purple.
CHECKER = np.zeros((32, 32, 3), np.uint8)
CHECKER[..., 0] = 255 * (np.indices((32, 32)).sum(axis=0) % 2)
CHECKER[..., 2] = 255 - CHECKER[..., 0]


def decoded(data: bytes) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float)


def test_fine_saturated_colour_survives() -> None:
    error = np.abs(decoded(jpeg.encode(CHECKER, jpeg.MOVING_QUALITY)) - CHECKER).mean()
    assert error < 5  # measured 2.4; with 4:2:0 it is 89


def test_a_picture_at_rest_is_closer_to_the_truth() -> None:
    rng = np.random.default_rng(1)
    noise = rng.integers(0, 256, (64, 64, 3), dtype=np.uint8)
    moving, resting = (
        np.abs(decoded(jpeg.encode(noise, quality)) - noise).mean()
        for quality in (jpeg.MOVING_QUALITY, jpeg.RESTING_QUALITY)
    )
    assert resting < 0.75 * moving  # measured 0.55


def test_a_view_that_is_not_contiguous_is_encoded_as_what_it_shows() -> None:
    flipped = jpeg.encode(CHECKER[:, ::-1], jpeg.RESTING_QUALITY)
    assert flipped == jpeg.encode(np.ascontiguousarray(CHECKER[:, ::-1]), jpeg.RESTING_QUALITY)


def test_a_picture_is_encoded_in_the_bytes_that_it_may_have() -> None:
    """Of a lower quality first, and then of half the size."""
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 256, (360, 640, 3), dtype=np.uint8)
    whole = jpeg.encode_within(picture, 92, math.inf)
    assert (whole.width, whole.height, whole.quality) == (640, 360, 92)
    assert whole.data == jpeg.encode(picture, 92)
    lower = jpeg.encode_within(picture, 92, len(whole.data) / 2)
    assert (lower.width, lower.height) == (640, 360)
    assert jpeg.LEAST_QUALITY <= lower.quality < 92
    assert len(lower.data) <= len(whole.data) / 2
    halved = jpeg.encode_within(picture, 92, len(whole.data) / 12)
    assert (halved.width, halved.height) == (320, 180)
    assert len(halved.data) <= len(whole.data) / 12
    assert decoded(halved.data).shape == (180, 320, 3)


def test_qualities_that_cannot_do_are_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    """As by one after the other. The last picture, halved twice, was 13 encodings and more."""
    picture = np.random.default_rng(1).integers(0, 256, (400, 800, 3), dtype=np.uint8)
    encode, tried = jpeg.encode, list[int]()

    def counted(rgb: NDArray[np.uint8], quality: int) -> bytes:
        tried.append(quality)
        return encode(rgb, quality)

    monkeypatch.setattr(jpeg, "encode", counted)
    whole = len(encode(picture, 92))
    for part in (1, 1.9, 2.1, 4, 40):
        tried.clear()
        found = jpeg.encode_within(picture, 92, whole / part)
        first, rgb = 92, picture
        while not (
            fitting := [q for q in (first, *jpeg.LOWER_QUALITIES) if q <= first and len(encode(rgb, q)) <= whole / part]
        ):
            if min(rgb.shape[:2]) < 2 * jpeg.SMALLEST:
                fitting = [jpeg.LEAST_QUALITY]
                break
            first, rgb = jpeg.MOVING_QUALITY, np.asarray(Image.fromarray(rgb).reduce(2))
        assert (found.quality, found.width) == (fitting[0], rgb.shape[1])
        assert found.data == encode(rgb, fitting[0])
        assert part > 2 or jpeg.LEAST_QUALITY not in tried
    assert len(tried) <= 7


def test_a_picture_that_cannot_have_so_few_bytes_is_encoded_all_the_same() -> None:
    tiny = jpeg.encode_within(CHECKER, 92, 1)
    assert (tiny.width, tiny.height, tiny.quality) == (32, 32, jpeg.LEAST_QUALITY)
    assert jpeg.encode_within(CHECKER, jpeg.LEAST_QUALITY, 1) == tiny


@pytest.mark.parametrize("per_frame", [None, 6_000])
def test_each_frame_of_a_falling_stone_is_encoded_once(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch, per_frame: int | None
) -> None:
    """The bytes of the frames before tell the quality that fits, but for the first ones."""
    encodings: list[int] = []
    encode = jpeg.encode

    def counted(rgb: NDArray[np.uint8], quality: int) -> bytes:
        encodings.append(quality)
        return encode(rgb, quality)

    monkeypatch.setattr(jpeg, "encode", counted)
    quality, allowance = Quality(), ByteAllowance(per_frame)
    stages = falling(preset("falling"), 16)
    for stage in stages:
        plan = quality.plan(stage.scene, (320, 180), Balance(exactness=0.5, pinned=False), allowance)
        picture = renderer.picture(stage.showing(plan.scene), *plan.size)
        picture.refine()
        encoding = plan.encoding or Encoding(jpeg.MOVING_QUALITY, math.inf, thrifty=False)
        made = jpeg.encode_within(picture.softened(), encoding.quality, encoding.most_bytes)
        if plan.encoding is not None:
            quality.encoded(Coded.of_jpeg(made, thrifty=False))
    assert len(stages) <= len(encodings) <= len(stages) + 3
