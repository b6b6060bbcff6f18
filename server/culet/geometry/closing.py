"""The closed bodies of a surface that may need a repair before it has any.

Every repair is tried only if no body is closed without it, or if what stays open is larger than what is closed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from culet.errors import MeshError
from culet.geometry.seams import cut_at_corners, widest_gap
from culet.geometry.shared_walls import without_shared_walls
from culet.geometry.surface import (
    NEAR,
    Points,
    SurfacePieces,
    Triangles,
    bodies_of,
    refuse_open,
    weld_near,
    without_collapsed,
    without_duplicates,
)

WELDS = (NEAR, 1e-5, 1e-4)
"""Distances between corners that are joined, in units of the mesh's extent, the smallest that closes a body. Designs
of cutters' tools and CAD have corners 1e-4 apart; more would move facets by what a picture shows."""

LOOSEST = 2e-4
"""In units of the body's own extent: corners farther apart than this are not joined, however large the mesh is."""

_EXTENT = 2.0
"""Of the mesh, which lies in the cube from -1 to 1."""


@dataclass(frozen=True, eq=False)
class Closed:
    """A surface with a closed body, and what was done to it."""

    points: Points
    bodies: SurfacePieces
    notes: list[str]

    @property
    def volume(self) -> float:
        """Of the largest closed body; 0 if none is."""
        return float(self.bodies.volume.max(initial=0.0))

    @property
    def settled(self) -> bool:
        """Whether there is a closed body and every open piece is smaller, by its box."""
        closed = self.bodies.closed
        if not closed.any():
            return False
        sizes = _boxes(self.points, self.bodies)
        return bool(sizes[~closed].max(initial=0.0) <= sizes[int(self.bodies.volume.argmax())])


def closed_bodies(points: Points, triangles: Triangles, given: int) -> Closed:
    """The surface with as little repair as closes its largest body; `points` are distinct, in the cube from -1 to 1.

    `given` counts the file's vertices that a triangle uses. MeshError says what keeps the surface open, and how wide
    its widest gap is.
    """
    attempts = _attempts(points, triangles)
    plain = best = next(attempts, None)
    while best is not None and not best.settled and (attempt := next(attempts, None)) is not None:
        if attempt.volume > 1.01 * best.volume:
            best = attempt
    if plain is None or best is None or not best.bodies.closed.any():
        _, near, _ = weld_near(points, triangles, NEAR * _EXTENT)
        if plain is None or not len(without_collapsed(near)):
            raise MeshError("the mesh is flat: every triangle is degenerate, two of its corners in one place")
        gap = widest_gap(plain.points, plain.bodies.triangles) / _EXTENT
        raise refuse_open(plain.bodies, gap, WELDS[-1])
    notes = best.notes
    if len(points) < given:
        notes = [f"{given} vertices, {len(points)} of them distinct: equal ones were joined.", *notes]
    return Closed(best.points, best.bodies, notes)


def _attempts(points: Points, triangles: Triangles) -> Iterator[Closed]:
    """The surface as it is, then with its inner walls gone, then with its seams closed at growing distances."""
    yield from _repaired(points, triangles, [], NEAR)
    fewest = len(points)
    for distance in WELDS:
        near_points, near_triangles, farthest = weld_near(points, triangles, distance * _EXTENT)
        gone = len(points) - len(near_points)
        if len(near_points) == fewest:
            continue
        fewest = len(near_points)
        note = (
            f"{gone} {'vertex' if gone == 1 else 'vertices'} nearer than {distance:g} of the extent to another joined, "
            f"the farthest {farthest / _EXTENT:.1e} away."
        )
        for attempt in _repaired(near_points, near_triangles, [note], distance):
            size = _boxes(attempt.points, attempt.bodies)[int(attempt.bodies.volume.argmax())]
            if farthest <= LOOSEST * size:
                yield attempt


def _repaired(points: Points, triangles: Triangles, notes: list[str], distance: float) -> Iterator[Closed]:
    count = len(triangles)
    solid = without_collapsed(triangles)
    if len(solid) < count:
        notes = [
            *notes, f"{count - len(solid)} of {count} triangles degenerate (two corners in one place): dropped."
        ]  # fmt: skip
    if len(solid) == 0:
        return
    yield from _without_walls(points, solid, notes)
    cut, number = cut_at_corners(points, without_duplicates(solid, keep_one=True), distance * _EXTENT)
    if number:
        said = f"{number} {'side' if number == 1 else 'sides'} cut where another's corner lies on it."
        yield from _without_walls(points, cut, [*notes, said])


def _without_walls(points: Points, solid: Triangles, notes: list[str]) -> Iterator[Closed]:
    once = without_duplicates(solid, keep_one=True)
    twice = len(solid) - len(once)
    said = [f"{twice} triangles given more than once: dropped."] if twice else []
    yield Closed(points, bodies_of(points, once), [*notes, *said])
    # Two bodies face to face: without the walls between them they are one.
    if twice:
        hollow = without_duplicates(solid, keep_one=False)
        if len(hollow):
            dropped = f"{len(solid) - len(hollow)} triangles of inner walls: dropped."
            yield Closed(points, bodies_of(points, hollow), [*notes, dropped])
    hollow = without_shared_walls(points, once)
    if 0 < len(hollow) < len(once):
        dropped = f"{len(solid) - len(hollow)} triangles of inner walls: dropped."
        yield Closed(points, bodies_of(points, hollow), [*notes, dropped])


def _boxes(points: Points, bodies: SurfacePieces) -> Points:
    """(K,) the longest side of each piece's box."""
    number = len(bodies.volume)
    low, high = np.full((number, 3), np.inf), np.full((number, 3), -np.inf)
    corners = points[bodies.triangles]
    np.minimum.at(low, bodies.piece, corners.min(axis=1))
    np.maximum.at(high, bodies.piece, corners.max(axis=1))
    sizes: Points = (high - low).max(axis=1)
    return sizes
