"""Stones that are inside each other where the scene has them: allowed, and said."""

from __future__ import annotations

import math
from itertools import combinations

from culet.simulation.solver.polyhedron import polyhedron_of
from culet.simulation.world import World

TOUCHING = 1e-3
"""R of overlap that is not worth a word: stones that lie against each other overlap by less."""
MOST = 8
"""Sentences; more are counted."""
EFFORT = 5e7
"""Products of the numbers of edges of two stones, summed over the pairs that are looked at: 0.15 s. All pairs of 64
brilliants are within it; 64 stones of a thousand corners in one place would take two minutes."""


def overlaps(world: World) -> list[str]:
    """A sentence for each pair of stones that overlap now, by their convex hulls."""
    placed = list(zip(world.bodies, world.state.bodies, strict=True))
    found, unseen, effort = [], 0, 0
    for (a, at_a), (b, at_b) in combinations(placed, 2):
        if math.dist(at_a.position, at_b.position) >= a.scale + b.scale:
            continue
        needed = len(polyhedron_of(a.shape).edges) * len(polyhedron_of(b.shape).edges)
        if effort + needed > EFFORT:
            unseen += 1
            continue
        effort += needed
        depth = -world.separation(a.name, b.name)
        if depth > TOUCHING:
            found.append(
                f"the stones {a.name!r} and {b.name!r} overlap by {depth:.2g} R: light belongs to the stone that it "
                "entered first, and once they move they are pushed apart"
            )
    more = [] if len(found) <= MOST else [f"{len(found) - MOST} more pairs of stones overlap"]
    if unseen:
        more.append(f"{unseen} more pairs of stones may overlap: they have too many edges to be looked at")
    return found[:MOST] + more
