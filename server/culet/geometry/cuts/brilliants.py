"""The brilliant on any convex outline: table, stars, kites, upper halves, girdle, lower halves and mains.

Let Y_k be where the lines that support the outline at the mains k and k + 1 meet. Mains that hold the culet (0, 0, -P)
and have their support line as their contour at the girdle meet along the line from the culet to Y_k, so that a point
of this line lies on both, and lower halves are the planes of a girdle's edge and this point. The crown is the same
with the table's outline, t times the girdle's, in the culet's place. So all planes of a sector share their corners
whatever the outline is, and the stone is convex as the outline is.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from culet.errors import MeshError
from culet.geometry.cuts.facets import Facets, Point, at
from culet.geometry.cuts.outlines import GirdleOutline, Points


class BrilliantProportions(Protocol):
    """What all brilliants have; angles hold where the support line is 1 from the axis."""

    @property
    def name(self) -> str: ...
    @property
    def table_percent(self) -> float: ...
    @property
    def crown_degrees(self) -> float: ...
    @property
    def pavilion_degrees(self) -> float: ...
    @property
    def star_percent(self) -> float: ...
    @property
    def lower_half_percent(self) -> float: ...
    @property
    def girdle_percent(self) -> float: ...


def brilliant_on(
    outline: GirdleOutline, cut: BrilliantProportions, *, culet: float = 0, keel: float = 0, least_star: float = 0
) -> Facets:
    """The facets on an outline of half width 1.

    culet: width of the facet at the bottom, of the outline's; keel: half the length of a ridge along x in which the
    mains end in place of a point; least_star: of the way from where stars would be level to the girdle, the part that
    they reach at least, whatever the cut says. MeshError if stars cannot slope.
    """
    table, half_girdle = cut.table_percent / 100, cut.girdle_percent / 100
    height = (1 - table) * math.tan(math.radians(cut.crown_degrees))
    depth = math.tan(math.radians(cut.pavilion_degrees))
    corners, meets, m = outline.corners, outline.meets(), outline.mains
    ends = [_end(corners, k, keel) for k in range(m)]
    tips = [_star_tip(outline, meets[k], k, cut, least_star) for k in range(m)]
    tips3 = [at(tip * meets[k], half_girdle + height * (1 - tip) / (1 - table)) for k, tip in enumerate(tips)]
    lows = [_low(corners[2 * k + 1], meets[k], ends[k], cut.lower_half_percent / 100) for k in range(m)]
    lows3 = [at(ends[k] + u * (meets[k] - ends[k]), -half_girdle - depth * (1 - u)) for k, u in enumerate(lows)]
    bottom = -half_girdle - depth

    def foot(k: int) -> Point:
        """Where the ridge of mains k and k + 1 ends: at the bottom, or on the culet."""
        end = at(ends[k], bottom)
        return end if culet == 0 else end + culet * depth / (lows3[k][2] - bottom) * (lows3[k] - end)

    tops = [at(table * corners[2 * k], half_girdle + height) for k in range(m)]
    facets = Facets(cut.name)
    facets.add("table", *tops)
    for k in range(m):
        after = (k + 1) % m
        main, odd, following = (corners[j % (2 * m)] for j in (2 * k, 2 * k + 1, 2 * k + 2))
        facets.add("star", tops[k], tips3[k], tops[after])
        facets.add("kite", at(main, half_girdle), tips3[k], tops[k], tips3[k - 1])
        for a, b in ((main, odd), (odd, following)):
            facets.add("upper half", at(a, half_girdle), at(b, half_girdle), tips3[k])
            facets.add("girdle", at(a, -half_girdle), at(b, -half_girdle), at(b, half_girdle), at(a, half_girdle))
            facets.add("lower half", at(a, -half_girdle), lows3[k], at(b, -half_girdle))
        facets.add("main", at(main, -half_girdle), lows3[k - 1], foot(k - 1), foot(k), lows3[k])
    if culet > 0:
        facets.add("culet", *(foot(k) for k in reversed(range(m))))
    return facets


def _end(corners: Points, k: int, keel: float) -> Points:
    """Which end of the keel the ridge of mains k and k + 1 goes to."""
    middle = corners[2 * k, 0] + corners[(2 * k + 2) % len(corners), 0]
    return np.array([math.copysign(keel, middle) if keel else 0.0, 0.0])


def _star_tip(outline: GirdleOutline, meet: Points, k: int, cut: BrilliantProportions, least: float) -> float:
    """Of the way from the axis to `meet`, where a star ends."""
    table, corners = cut.table_percent / 100, outline.corners
    a, b = table * corners[2 * k], table * corners[(2 * k + 2) % len(corners)]
    girdle = float(corners[2 * k + 1] @ meet / (meet @ meet))
    edge = float(_cross(a, b - a) / _cross(meet, b - a))
    tip = max(edge + cut.star_percent / 100 * (girdle - edge), table + least * (girdle - table))
    if not table < tip < girdle:
        raise MeshError(f"{cut.name}: the stars do not slope")
    return tip


def _low(odd: Points, meet: Points, end: Points, lower: float) -> float:
    """Of the way from the keel's end to `meet`, where lower halves end."""
    way = meet - end
    return (1 - lower) * float((odd - end) @ way / (way @ way))


def _cross(a: Points, b: Points) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
