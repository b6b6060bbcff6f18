"""Densities of the named materials, kg/m^3: what a stone weighs that is given neither a density nor a mass.

N-BK7's is SCHOTT's (data sheet); the others are in the middle of the ranges of the International Gem Society's table of
specific gravities (gemsociety.org), which are within 1 %, but for cubic zirconia's (5500 to 6000, by its stabiliser).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from culet.scene.stone import IndexMaterial, SellmeierMaterial

DENSITIES: Mapping[str, float] = MappingProxyType(
    {
        "diamond": 3520,
        "diamond-turri": 3520,
        "moissanite": 3220,
        "cubic-zirconia": 5750,
        "sapphire": 4000,
        "ruby": 4000,
        "emerald": 2720,
        "spinel": 3600,
        "yag": 4600,
        "quartz": 2650,
        "strontium-titanate": 5130,
        "rutile": 4250,
        "bk7": 2510,
        "classic": 3520,
    }
)
"""By name."""


def density_of(material: str | IndexMaterial | SellmeierMaterial) -> float:
    """kg/m^3; diamond's for a material that is described by its indices."""
    return DENSITIES[material if isinstance(material, str) else "diamond"]
