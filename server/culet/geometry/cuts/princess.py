"""The princess: chevrons fan from the corners to points of the sides' middle lines, which are convex profiles."""

from __future__ import annotations

import math

import numpy as np

from culet.errors import MeshError
from culet.geometry.cuts.facets import Facets, Point
from culet.scene.cuts import PrincessCut


def princess(cut: PrincessCut) -> Facets:
    """To each side a bezel on the girdle's edge, a star on the table's edge, and two halves from the corners; below,
    chevrons from the corners, of which the first holds the whole edge of the girdle, and mains that hold a corner and
    the culet. Longer ones are stretched along x, as ovals are. MeshError if the profile is not convex.
    """
    half_girdle, table = cut.girdle_percent / 100, cut.table_percent / 100
    depth = 2 * cut.pavilion_percent / 100
    tip = table + (1 - table) * cut.star_percent / 100
    tip_height = half_girdle + (1 - tip) * math.tan(math.radians(cut.crown_degrees))
    top = tip_height + (tip - table) * math.tan(math.radians(cut.star_degrees))
    end = cut.corner_percent / 100
    end_height = -half_girdle - depth * (1 - end / 2)
    profile = _profile(cut, half_girdle, (end, end_height), depth / 2)
    facets = Facets(cut.name)

    def corner(side: int, u: float, v: float, z: float) -> Point:
        """u outward across the side, v along it."""
        (ex, ey), (fx, fy) = _ACROSS[side], _ACROSS[(side + 1) % 4]
        return np.array([cut.length_to_width * (u * ex + v * fx), u * ey + v * fy, z])

    facets.add("table", *(corner(side, table, table, top) for side in range(4)))
    for side in range(4):
        k1, k2 = corner(side, 1, -1, half_girdle), corner(side, 1, 1, half_girdle)
        t1, t2 = corner(side, table, -table, top), corner(side, table, table, top)
        meet = corner(side, tip, 0, tip_height)
        facets.add("star", t1, meet, t2)
        facets.add("crown half", k2, t2, meet)
        facets.add("crown half", k1, meet, t1)
        facets.add("bezel", k1, k2, meet)
        c1, c2 = corner(side, 1, -1, -half_girdle), corner(side, 1, 1, -half_girdle)
        facets.add("girdle", c1, c2, k2, k1)
        points = [corner(side, u, 0, z) for u, z in profile]
        facets.add("chevron 1", c2, c1, points[1])
        for number in range(1, cut.chevrons):
            facets.add(f"chevron {number + 1}", c2, points[number], points[number + 1])
            facets.add(f"chevron {number + 1}", c1, points[number + 1], points[number])
        culet = np.array([0, 0, -half_girdle - depth])
        facets.add("main", c2, points[-1], culet, corner((side + 1) % 4, end, 0, end_height))
    return facets


_ACROSS = ((1, 0), (0, 1), (-1, 0), (0, -1))


def _profile(
    cut: PrincessCut, half_girdle: float, end: tuple[float, float], end_slope: float
) -> list[tuple[float, float]]:
    """Points of a parabola (a quadratic Bezier curve) from the girdle, where it slopes by `pavilion_degrees`, to where
    the mains begin, with their slope there: (distance from the axis, height)."""
    slope = math.tan(math.radians(cut.pavilion_degrees))
    (u0, z0), (u1, z1) = (1.0, -half_girdle), end
    control = (z0 - slope * u0 - z1 + end_slope * u1) / (end_slope - slope) if slope != end_slope else math.inf
    if not u1 < control < u0:
        raise MeshError(f"{cut.name}: the chevrons' slope at the girdle, the corners' mains and the depth do not fit")
    z = z0 - slope * (u0 - control)
    ways = np.arange(cut.chevrons + 1) / cut.chevrons
    return [
        (
            (1 - w) ** 2 * u0 + 2 * w * (1 - w) * control + w * w * u1,
            (1 - w) ** 2 * z0 + 2 * w * (1 - w) * z + w * w * z1,
        )
        for w in ways.tolist()
    ]
