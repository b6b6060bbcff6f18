"""Open seams of a surface: where they gape, how wide, and how they are closed."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from culet.geometry.surface import Edges, Points, Triangles, edges_of

SIDES_LIMIT = 20_000
"""Open sides beyond which none is cut at the corners on it: what has so many is no solid with a flaw."""

PAIRS_LIMIT = 1_000_000
"""Pairs of an open side and a corner that may lie on it, at most: half a second."""


def cut_at_corners(vertices: Points, triangles: Triangles, distance: float) -> tuple[Triangles, int]:
    """The surface with its open sides cut at the open corners that lie within `distance` of them; how many were cut.

    One long side against two short ones, a T-junction, is open although nothing gapes.
    """
    cut = 0
    for _ in range(3):  # one side of a triangle at a time
        fresh = _cut_once(vertices, triangles, distance)
        if fresh is None:
            break
        triangles, more = fresh
        cut += more
    return triangles, cut


def widest_gap(vertices: Points, triangles: Triangles) -> float:
    """The largest distance from an open corner to the nearest other one; 0 if the surface is closed."""
    edges = edges_of(triangles)
    corners = np.unique(_ends(triangles, _open_sides(edges)))
    if len(corners) < 2:
        return 0.0
    distance, _ = cKDTree(vertices[corners]).query(vertices[corners], k=2)
    return float(distance[:, 1].max())


def _open_sides(edges: Edges) -> NDArray[np.int64]:
    return np.flatnonzero(edges.uses[edges.of_side] == 1)


def _ends(triangles: Triangles, sides: NDArray[np.int64]) -> NDArray[np.int64]:
    """(S, 2) the vertices at which sides start and end, sides counted as in `Edges`."""
    own, first = sides % len(triangles), sides // len(triangles)
    return np.column_stack([triangles[own, first], triangles[own, (first + 1) % 3]])


def _cut_once(vertices: Points, triangles: Triangles, distance: float) -> tuple[Triangles, int] | None:
    sides = _open_sides(edges_of(triangles))
    if not 0 < len(sides) <= SIDES_LIMIT:
        return None
    ends = _ends(triangles, sides)
    start, end = vertices[ends[:, 0]], vertices[ends[:, 1]]
    lengths = np.sqrt(((end - start) ** 2).sum(axis=1))
    corners = np.unique(ends)
    tree = cKDTree(vertices[corners])
    middle, reach = (start + end) / 2, lengths / 2 + distance
    if int(tree.query_ball_point(middle, reach, return_length=True).sum()) > PAIRS_LIMIT:
        return None
    near = tree.query_ball_point(middle, reach)
    side = np.repeat(np.arange(len(sides)), [len(some) for some in near])
    corner = corners[np.concatenate([np.array(some, np.int64) for some in near])]
    direction = (end - start)[side] / np.maximum(lengths, distance)[side, None]
    offset = vertices[corner] - start[side]
    along = np.einsum("ij,ij->i", offset, direction)
    aside = np.sqrt(((offset - along[:, None] * direction) ** 2).sum(axis=1))
    on = (aside <= distance) & (along > distance) & (along < lengths[side] - distance)
    on &= (corner != ends[side, 0]) & (corner != ends[side, 1])
    if not on.any():
        return None
    order = np.lexsort((along[on], side[on]))
    side, corner = side[on][order], corner[on][order]
    whole = np.ones(len(triangles), np.bool_)
    fresh: list[tuple[int, int, int]] = []
    cut = 0
    bounds = np.searchsorted(side, np.arange(len(sides) + 1))
    for k in np.unique(side).tolist():
        own, first = int(sides[k] % len(triangles)), int(sides[k] // len(triangles))
        if not whole[own]:
            continue
        whole[own] = False
        a, b, c = (int(triangles[own, (first + turn) % 3]) for turn in range(3))
        chain = [a, *corner[bounds[k] : bounds[k + 1]].tolist(), b]
        fresh += [(p, q, c) for p, q in pairwise(chain)]
        cut += 1
    return np.concatenate([triangles[whole], np.array(fresh, np.int64)]), cut
