"""What can be said, and changed, of the angles of a stone's tiers with all meets kept: see `cutting.meets`."""

from __future__ import annotations

import math
from collections.abc import Sequence

from culet.errors import MeshError
from culet.geometry.cutting.meets import (
    FARTHEST,
    FIELD,
    LEAST_DEGREES,
    MOST_DEGREES,
    angle_of_tiers,
    independent_tiers,
    reach_of_tier,
)
from culet.geometry.cutting.recut import OF_A_SHAPE, recut_shape
from culet.geometry.cutting.tiers import TierAngle, Tiers
from culet.geometry.shape import Shape
from culet.scene.recut import Recut, TierAngles

PARTS = 100
"""Of a degree, to which ends are rounded inward: finer than anybody cuts."""


def tiers_of(stone: Shape, uncut: Shape, recut: Recut | None, reach: int | None = None) -> Tiers:
    """Of a stone, which `recut` made of `uncut`. Ends are those that are refused at once, and of the tier `reach` those
    at which all meets are kept while other angles that are asked for stay. MeshError for a stone of no tiers, of too
    many facets, or that is not convex, and for a tier that cannot be turned."""
    if not stone.convex:
        raise MeshError(f"{stone.name}: expected a convex stone, as designs are; got one that is not", FIELD)
    given = recut or Recut()
    begin = recut_shape(uncut, given.model_copy(update={"angles": TierAngles(), "table_percent": None}))
    own, planes = _numbers(begin), begin.planes @ OF_A_SHAPE.T
    free = independent_tiers(begin.name, planes, own)
    before, now = angle_of_tiers(planes, own), angle_of_tiers(stone.planes @ OF_A_SHAPE.T, _numbers(stone))
    reached = None
    if reach is not None:
        others = {tier: degrees for tier, degrees in given.angles.items() if tier != reach}
        least, most = reach_of_tier(begin.name, planes, own, reach, others)
        reached = min(_up(least), most), max(_down(most), least)
    found = []
    for tier, degrees in now.items():
        facets = [k for k, name in enumerate(stone.names) if name.tier == tier]
        if tier in before and LEAST_DEGREES <= before[tier] <= MOST_DEGREES:
            ends = max(LEAST_DEGREES, _up(before[tier] - FARTHEST)), min(MOST_DEGREES, _down(before[tier] + FARTHEST))
            if tier == reach and reached is not None:
                ends = reached
            found.append(
                TierAngle(
                    tier=tier,
                    names=tuple(dict.fromkeys(stone.names[k].name for k in facets if stone.names[k].name)),
                    facets=len(facets),
                    side="crown" if stone.planes[facets[0], 1] > 0 else "pavilion",
                    degrees=degrees,
                    independent=tier in free or tier in given.angles,
                    least=ends[0],
                    most=ends[1],
                )
            )
    return Tiers(tuple(found))


def _numbers(shape: Shape) -> Sequence[int]:
    return [name.tier for name in shape.names]


def _up(degrees: float) -> float:
    return math.ceil(degrees * PARTS) / PARTS


def _down(degrees: float) -> float:
    return math.floor(degrees * PARTS) / PARTS
