"""Tiers of facets that a file gives as planes: angle, distance and index are what the plane has."""

from __future__ import annotations

import math
from collections.abc import Sequence

from culet.geometry.designs.design import Facet, PlaneRow, Tier, Wheel, side_and_angle, without_noise


def tier_of(planes: Sequence[PlaneRow], names: Sequence[str], wheel: Wheel, notes: str = "") -> Tier:
    """The tier of at least one facet; angle and distance are the first one's."""
    side, angle = side_and_angle(planes[0][:3])
    facets = tuple(
        Facet(wheel.index(math.atan2(plane[0], plane[1])), name, plane)
        for plane, name in zip(planes, names, strict=True)
    )
    return Tier(side, angle, without_noise(planes[0][3], 8), facets, notes)
