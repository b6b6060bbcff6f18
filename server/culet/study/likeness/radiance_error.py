"""How far a picture is from its reference in radiance, and one of another size from it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

Image = NDArray[np.floating[Any]]
"""(height, width, 3)."""


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
