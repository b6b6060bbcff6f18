"""What a stone's material does to the light that it is graded by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from culet.optics.materials import material_of
from culet.rendering.chains import asked_absorption
from culet.scene.stone import StoneSettings

SODIUM_D = 589.3
"""nm: the light at which gemmologists give refractive indices."""
BLUE, RED = 450.0, 650.0
"""nm: the two wavelengths whose parting is fire."""


@dataclass(frozen=True)
class StoneOptics:
    """Of one stone."""

    index: float
    """At the sodium line."""
    blue_index: float
    red_index: float
    absorption: float = 0.0
    """At the sodium line, per R of the stone's own shape."""

    @classmethod
    def of_index(cls, index: float) -> StoneOptics:
        """Clear and without dispersion."""
        return cls(index, index, index)


def optics_of(stone: StoneSettings, millimetres: float, *, coloured: bool = False) -> StoneOptics:
    """Of a stone of a scene whose R is so long: clear, since grades are of the cut, or else as the sodium line sees
    the stone."""
    material = material_of(stone.material)
    index, blue, red = material.index(np.array([SODIUM_D, BLUE, RED]), clamp=True).tolist()
    if not coloured:
        return StoneOptics(index, blue, red)
    line = np.array([SODIUM_D])
    own = float(material.absorption_per_mm(line)[0]) * millimetres + float(asked_absorption(stone, line)[0])
    return StoneOptics(index, blue, red, own * stone.scale)
