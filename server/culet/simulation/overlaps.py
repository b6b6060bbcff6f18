"""Stones that are inside each other where the scene has them: allowed, and said."""

from __future__ import annotations

import math
from itertools import combinations

from culet.simulation.world import World

TOUCHING = 1e-3
"""R of overlap that is not worth a word: stones that lie against each other overlap by less."""
MOST = 8
"""Sentences; more are counted."""


def overlaps(world: World) -> list[str]:
    """A sentence for each pair of stones that overlap now, by their convex hulls."""
    placed = list(zip(world.bodies, world.state.bodies, strict=True))
    found = []
    for (a, at_a), (b, at_b) in combinations(placed, 2):
        if math.dist(at_a.position, at_b.position) >= a.scale + b.scale:
            continue
        depth = -world.separation(a.name, b.name)
        if depth > TOUCHING:
            found.append(
                f"the stones {a.name!r} and {b.name!r} overlap by {depth:.2g} R: light belongs to the stone that it "
                "entered first, and once they move they are pushed apart"
            )
    more = [] if len(found) <= MOST else [f"{len(found) - MOST} more pairs of stones overlap"]
    return found[:MOST] + more
