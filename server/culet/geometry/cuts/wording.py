"""What is said of a stone's shape above its cutting diagram."""

from __future__ import annotations

import textwrap

from culet.geometry.shape import Shape
from culet.scene.cuts import TITLES, AnyCut, proportions
from culet.scene.stone import StoneSettings

LINE = 90
"""Characters of a diagram's heading."""


def headings_of(stone: StoneSettings, shape: Shape) -> list[str]:
    """Of a cut its title and proportions; of a mesh or a design its name."""
    if stone.mesh is None:
        return cut_headings(proportions(stone.cut))
    return [shape.name]


def cut_headings(cut: AnyCut) -> list[str]:
    """Title and proportions."""
    said = (f"{name.replace('_', ' ')} {value:g}" for name, value in cut.model_dump(exclude={"name"}).items())
    return [TITLES[cut.name], *textwrap.wrap(", ".join(said), LINE)]
