"""How far a picture is from its reference: in radiance, and to the eye."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from skimage import color, metrics

from culet.optics.gamut import into_gamut
from culet.optics.tone import tone_map
from culet.scene.model import Film

Image = NDArray[np.floating[Any]]

_lab: Any = color.rgb2lab  # scikit-image has types for a part of itself only
_deltae: Any = color.deltaE_ciede2000
_ssim: Any = metrics.structural_similarity


def radiance_error(image: Image, reference: Image) -> dict[str, float]:
    """`rmse`, `max` and `bias` (the mean of image - reference) in linear radiance, over channels and finite pixels."""
    difference = image.astype(np.float64) - reference
    difference = difference[np.isfinite(difference)]
    if difference.size == 0:
        difference = np.zeros(1)
    return {
        "rmse": float(np.sqrt(np.mean(difference**2))),
        "max": float(np.abs(difference).max()),
        "bias": float(difference.mean()),
    }


def non_finite(image: Image) -> int:
    """Numbers that are NaN or infinite."""
    return int(np.count_nonzero(~np.isfinite(image)))


def as_shown(image: Image, film: Film) -> NDArray[np.float64]:
    """(height, width, 3) linear radiance as the film shows it, 0 to 1."""
    exposed = film.exposure * np.nan_to_num(image.astype(np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    return np.clip(tone_map(into_gamut(exposed, film.gamut), film.tone_map), 0, 1)


def colour_difference(image: Image, reference: Image, film: Film) -> float:
    """Mean CIEDE2000 of the two as shown: 1 is just noticeable, side by side."""
    return mean_ciede2000(as_shown(image, film), as_shown(reference, film))


def mean_ciede2000(shown: NDArray[Any], reference: NDArray[Any]) -> float:
    """Of two sRGB pictures, in 8 bits or from 0 to 1."""
    return float(np.mean(_deltae(_lab(reference), _lab(shown))))


def structural_similarity(shown: NDArray[np.uint8], reference: NDArray[np.uint8]) -> float:
    """Mean SSIM of two 8-bit pictures, 1 for equal ones (Wang et al., 2004: Gaussian weights of 1.5 pixels)."""
    options = {"gaussian_weights": True, "sigma": 1.5, "use_sample_covariance": False, "data_range": 255}
    return float(_ssim(reference, shown, channel_axis=-1, **options))


def enlarged(image: Image, height: int, width: int) -> Image:
    """A smaller picture stretched over a larger one's pixels, linear between centres, as a browser shows it."""
    if image.shape[:2] == (height, width):
        return image
    rows = (np.arange(height) + 0.5) * image.shape[0] / height - 0.5
    columns = (np.arange(width) + 0.5) * image.shape[1] / width - 0.5
    places = np.meshgrid(rows, columns, indexing="ij")
    return np.stack(
        [map_coordinates(image[..., k].astype(np.float64), places, order=1, mode="nearest") for k in range(3)], axis=-1
    )
