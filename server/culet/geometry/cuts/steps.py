"""Step cuts: stacked octagons with parallel sides, so that all facets are plane whatever the slopes."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from culet.errors import MeshError
from culet.geometry.cuts.facets import Facets, Points, at


class StepProportions(Protocol):
    """What all step cuts have."""

    @property
    def name(self) -> str: ...
    @property
    def table_percent(self) -> float: ...
    @property
    def crown_steps(self) -> int: ...
    @property
    def crown_degrees(self) -> float: ...
    @property
    def crown_step_degrees(self) -> float: ...
    @property
    def pavilion_steps(self) -> int: ...
    @property
    def pavilion_degrees(self) -> float: ...
    @property
    def pavilion_step_degrees(self) -> float: ...
    @property
    def girdle_percent(self) -> float: ...


_PLACES = ("end", "corner", "side", "corner") * 2


def step_cut(cut: StepProportions, length_to_width: float, corner: float) -> Facets:
    """`corner` is what is cut off a corner each way, of half the width.

    Each step takes the same part of the way from the girdle to the table, or to the keel. Corners shrink as the width
    does, so that the edges of one corner are parallel on all levels, and ends, corners and keel vanish together.
    MeshError if steps are flatter than level.
    """
    half_girdle = cut.girdle_percent / 100
    up = _levels(cut, "crown", cut.crown_degrees, cut.crown_step_degrees, cut.crown_steps, 1 - cut.table_percent / 100)
    down = _levels(cut, "pavilion", cut.pavilion_degrees, cut.pavilion_step_degrees, cut.pavilion_steps, 1.0)

    def octagon(inward: float, z: float) -> list[Points]:
        a, b = length_to_width - inward, 1 - inward
        k = corner * b if b > 1e-12 else 0.0
        x, y = a - k, b - k
        plan = ((a, y), (x, b), (-x, b), (-a, y), (-a, -y), (-x, -b), (x, -b), (a, -y))
        return [at(p, z) for p in plan]

    facets = Facets(cut.name)
    crown = [octagon(inward, half_girdle + z) for inward, z in up]
    pavilion = [octagon(inward, -half_girdle - z) for inward, z in down]
    facets.add("table", *crown[-1])
    for number in reversed(range(1, len(crown))):
        _ring(facets, f"crown {number}", crown[number - 1], crown[number])
    _ring(facets, "girdle", pavilion[0], crown[0])
    for number in range(1, len(pavilion)):
        _ring(facets, f"pavilion {number}", pavilion[number], pavilion[number - 1])
    return facets


def _levels(
    cut: StepProportions, part: str, slope: float, flatter: float, steps: int, way: float
) -> list[tuple[float, float]]:
    """How far inward each level is, and how far from the girdle."""
    slopes = slope - flatter * np.arange(steps)
    if not slopes.min() > 0:
        raise MeshError(f"{cut.name}: the {part}'s last step would slope by {slopes.min():.4g} degrees")
    away = np.cumsum(way / steps * np.tan(np.radians(slopes)))
    return [(0.0, 0.0), *((way * (k + 1) / steps, float(z)) for k, z in enumerate(away))]


def _ring(facets: Facets, label: str, low: list[Points], high: list[Points]) -> None:
    for k in range(8):
        facets.add(f"{label} {_PLACES[k]}", low[k - 1], low[k], high[k], high[k - 1])
