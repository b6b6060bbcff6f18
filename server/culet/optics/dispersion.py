"""Index of refraction as a function of wavelength."""

from __future__ import annotations

import math
from collections.abc import Sequence

from culet.errors import SceneError
from culet.scene.model import IndexMaterial, SellmeierMaterial

RGB_NANOMETRES = (656.3, 546.1, 435.8)
"""Wavelengths that stand for the three channels: the Fraunhofer lines C (hydrogen) and e (mercury), and mercury's g."""

PETER_1923 = ((0.3306, 0.1750), (4.3356, 0.1060))
"""Diamond: F. Peter, Z. Phys. 15, 358 (1923), 226 to 760 nm; Sellmeier pairs (B, C in micrometres)."""

CLASSIC_INDICES = (1.7, 1.8, 1.9)
"""The report's indices, chosen by its author to exaggerate the fire."""


def sellmeier(pairs: Sequence[tuple[float, float]], nanometres: float) -> float:
    """n from n^2 = 1 + sum B l^2 / (l^2 - C^2), l and C in micrometres; NaN where n^2 < 0."""
    square = (nanometres / 1000) ** 2
    n_squared = 1 + sum(b * square / (square - c * c) if square != c * c else math.inf for b, c in pairs)
    return math.sqrt(n_squared) if n_squared >= 0 else math.nan


def channel_indices(
    material: str | IndexMaterial | SellmeierMaterial,
) -> tuple[float, float, float]:
    """The indices of the red, green and blue channel; SceneError if they are not those of a transparent solid."""
    if isinstance(material, IndexMaterial):
        return material.ior
    if material == "classic":
        return CLASSIC_INDICES
    pairs = material.sellmeier if isinstance(material, SellmeierMaterial) else PETER_1923
    red, green, blue = (sellmeier(pairs, wavelength) for wavelength in RGB_NANOMETRES)
    for wavelength, index in zip(RGB_NANOMETRES, (red, green, blue), strict=True):
        if not 1 <= index <= 10:
            raise SceneError(
                f"stones.0.material.sellmeier: expected an index from 1 to 10, got {index:g} at {wavelength} nm",
                "stones.0.material.sellmeier",
            )
    return red, green, blue
