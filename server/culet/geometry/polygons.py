"""Facets as polygons: their triangles, and the edges between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape


def fan(polygons: Sequence[Sequence[int]]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Triangles (T, 3) of convex polygons, and (T,) the polygon that each belongs to."""
    triangles: list[tuple[int, int, int]] = []
    owner: list[int] = []
    for facet, corners in enumerate(polygons):
        for k in range(1, len(corners) - 1):
            triangles.append((corners[0], corners[k], corners[k + 1]))
            owner.append(facet)
    return np.array(triangles, np.int32).reshape(-1, 3), np.array(owner, np.int32)


def loops(edges: NDArray[np.int64]) -> list[list[int]] | None:
    """Closed loops that directed edges (E, 2) form; None if a vertex begins two of them, or an end stays open."""
    following = {int(a): int(b) for a, b in edges}
    if len(following) != len(edges):
        return None
    found = []
    while following:
        start, end = following.popitem()
        loop = [start]
        while end != start:
            loop.append(end)
            if end not in following:
                return None
            end = following.pop(end)
        found.append(loop)
    return found


def edges_of_facets(shape: Shape) -> NDArray[np.int32]:
    """(E, 4) v0, v1, facet a, facet b: every edge between two facets, once.

    The edge runs from v0 to v1 counter-clockwise about facet a, seen from outside, and from v1 to v0 about facet b.
    """
    a = shape.triangles.astype(np.int64)
    directed = np.concatenate([a[:, [0, 1]], a[:, [1, 2]], a[:, [2, 0]]])
    facet = np.tile(shape.facet_of_triangle, 3)
    count = len(shape.vertices)
    key = directed[:, 0] * count + directed[:, 1]
    order = np.argsort(key)
    reverse = directed[:, 1] * count + directed[:, 0]
    partner = order[np.searchsorted(key[order], reverse).clip(max=len(key) - 1)]
    shared = (key[partner] == reverse) & (facet != facet[partner]) & (directed[:, 0] < directed[:, 1])
    return np.column_stack([directed[shared], facet[shared], facet[partner[shared]]]).astype(np.int32)
