"""Three indices of refraction, one for each channel: the cheap way to see dispersion."""

from __future__ import annotations

from functools import lru_cache

from culet.optics.formulas import sellmeier
from culet.optics.materials import CLASSIC_INDICES, PETER_1923, material_of
from culet.optics.wavelengths import RGB_NANOMETRES
from culet.scene.stone import IndexMaterial, SellmeierMaterial

__all__ = ["CLASSIC_INDICES", "PETER_1923", "RGB_NANOMETRES", "channel_indices", "sellmeier"]


@lru_cache(maxsize=256)
def channel_indices(
    material: str | IndexMaterial | SellmeierMaterial,
) -> tuple[float, float, float]:
    """The indices of the red, green and blue channel; SceneError if they are not those of a transparent solid."""
    red, green, blue = material_of(material).index(RGB_NANOMETRES).tolist()
    return red, green, blue
