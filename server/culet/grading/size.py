"""How large and how heavy a stone is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from culet.geometry.shape import Shape
from culet.optics.densities import density_of
from culet.scene.stone import CARATS_PER_GRAM, StoneSettings


@dataclass(frozen=True)
class Size:
    """Millimetres and carats."""

    length: float
    """The larger extent across the table."""
    width: float
    depth: float
    carats: float
    density: float
    """kg/m^3, by which it weighs so."""

    def words(self) -> str:
        """For people."""
        return (
            f"{self.length:.2f} x {self.width:.2f} x {self.depth:.2f} mm, {self.carats:.3g} ct at "
            f"{self.density / 1000:.2f} g/cm^3"
        )


def size_of(shape: Shape, stone: StoneSettings, millimetres: float) -> Size:
    """Of a stone of a scene whose R is so long; by the stone's mass, or its density, or else its material's."""
    radius = stone.scale * millimetres
    across, depth, along = (radius * np.ptp(shape.vertices, axis=0)).tolist()
    grams_by_density = shape.mass.volume * radius**3 * 1e-6  # mm^3 to g for each kg/m^3
    density = density_of(stone.material) if stone.density is None else stone.density
    if stone.mass is not None:
        density = stone.mass / CARATS_PER_GRAM / grams_by_density
    carats = CARATS_PER_GRAM * density * grams_by_density
    return Size(max(across, along), min(across, along), depth, carats, density)
