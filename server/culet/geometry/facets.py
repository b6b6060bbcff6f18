"""Triangles that lie in one plane, gathered into facets."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from culet.geometry.surface import Points, Triangles, edges_of

FLATNESS = 1e-6
"""Adjacent triangles are one facet if all their vertices lie within this of its plane, in units of R. Single precision
and six printed digits leave about 2e-7; a sphere of 200 000 triangles bends by 6e-5 from one to the next. Larger
flattens fine facets, and with it moves what they reflect by FLATNESS / size radians; smaller leaves the two triangles
of a quad as two facets with a crease between them, and their half-spaces cost time for nothing."""


def neighbours(triangles: Triangles) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of each edge of two triangles: (P, 2) the triangles, and (P, 4) its two ends and the corners opposite to it."""
    count = len(triangles)
    sides = edges_of(triangles).pairs()
    pair, side = sides % count, sides // count
    first = pair[:, 0]
    ends = triangles[first, side[:, 0]], triangles[first, (side[:, 0] + 1) % 3]
    opposite = triangles[first, (side[:, 0] + 2) % 3], triangles[pair[:, 1], (side[:, 1] + 2) % 3]
    return pair, np.column_stack([*ends, *opposite])


def bend(vertices: Points, corners: NDArray[np.int64]) -> NDArray[np.float64]:
    """(P,) how far each pair of neighbours is from flat: the least height of the tetrahedron that they span.

    Positive where the surface is concave. The least height, not the one over the first triangle: the plane of a sliver
    means nothing, but a tetrahedron with a sliver is thin.
    """
    p, q, a, b = (vertices[corners[:, k]] for k in range(4))
    six_volumes = np.einsum("ij,ij->i", np.cross(q - p, a - p), b - p)
    double_areas = [_norm(np.cross(v - u, w - u)) for u, v, w in ((p, q, a), (p, q, b), (p, a, b), (q, a, b))]
    largest = np.max(double_areas, axis=0)
    heights: NDArray[np.float64] = np.zeros_like(six_volumes)
    np.divide(six_volumes, largest, out=heights, where=largest > 0)
    return heights


def facets_of(vertices: Points, triangles: Triangles, tolerance: float) -> NDArray[np.int64]:
    """(T,) facet of each triangle: adjacent triangles whose vertices lie within `tolerance` of a common plane."""
    normals, areas = _normals(vertices, triangles)
    pair, corners = neighbours(triangles)
    heights = abs(bend(vertices, corners))
    # A triangle lower than the tolerance has no direction of its own; elsewhere a fold is not flat.
    sides = vertices[np.roll(triangles, -1, axis=1)] - vertices[triangles]
    thin = 2 * areas < tolerance * np.sqrt((sides**2).sum(axis=2)).max(axis=1)
    agree = np.einsum("ij,ij->i", normals[pair[:, 0]], normals[pair[:, 1]]) > 0
    flat = (heights <= tolerance) & (agree | thin[pair].any(axis=1))
    linked = pair[flat]
    count = len(triangles)
    number, label = connected_components(
        coo_array((np.ones(len(linked)), linked.T), shape=(count, count)), directed=False
    )
    label = label.astype(np.int64)
    planes = planes_of(vertices, triangles, label, number)
    off = abs(np.einsum("tkj,tj->tk", vertices[triangles], planes[label, :3]) - planes[label, 3][:, None]).max(axis=1)
    folded = (np.einsum("ij,ij->i", normals, planes[label, :3]) <= 0) & ~thin
    curved = np.zeros(number, np.bool_)
    curved[label[(off > tolerance) | folded]] = True
    if not curved.any():
        flat_label: NDArray[np.int64] = label
        return flat_label
    return _grown(vertices, triangles, label, curved, linked, normals, areas, thin, tolerance)


def planes_of(vertices: Points, triangles: Triangles, facet: NDArray[np.int64], number: int) -> NDArray[np.float64]:
    """(F, 4) the area-weighted normal of each facet's triangles, and the middle of its vertices' offsets."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area_vectors: Points = np.cross(b - a, c - a)
    sums: Points = np.column_stack([np.bincount(facet, area_vectors[:, k], number) for k in range(3)])
    lengths = _norm(sums)
    normals = np.divide(sums, lengths[:, None], out=np.zeros_like(sums), where=lengths[:, None] > 0)
    heights = np.einsum("tkj,tj->tk", vertices[triangles], normals[facet])
    low, high = np.full(number, np.inf), np.full(number, -np.inf)
    np.minimum.at(low, facet, heights.min(axis=1))
    np.maximum.at(high, facet, heights.max(axis=1))
    return np.column_stack([normals, (low + high) / 2])


def _grown(
    vertices: Points,
    triangles: Triangles,
    label: NDArray[np.int64],
    curved: NDArray[np.bool_],
    linked: NDArray[np.int64],
    normals: Points,
    areas: NDArray[np.float64],
    thin: NDArray[np.bool_],
    tolerance: float,
) -> NDArray[np.int64]:
    """Split components that bend little by little: grow each facet from its largest triangle, in that one's plane."""
    inside = curved[label[linked[:, 0]]]
    links: dict[int, list[int]] = {}
    for a, b in linked[inside].tolist():
        links.setdefault(a, []).append(b)
        links.setdefault(b, []).append(a)
    result = label.copy()
    members = np.flatnonzero(curved[label])
    result[members] = -1
    following = int(label.max()) + 1
    corners = vertices[triangles]
    for seed in members[np.argsort(-areas[members], kind="stable")].tolist():
        if result[seed] >= 0:
            continue
        result[seed] = following
        normal, origin = normals[seed], corners[seed, 0]
        waiting = deque([seed])
        while waiting:
            for other in links.get(waiting.popleft(), ()):
                if result[other] >= 0 or not (thin[other] or normals[other] @ normal > 0):
                    continue
                if abs((corners[other] - origin) @ normal).max() <= tolerance:
                    result[other] = following
                    waiting.append(other)
        following += 1
    _, compact = np.unique(result, return_inverse=True)
    return compact.astype(np.int64)


def _normals(vertices: Points, triangles: Triangles) -> tuple[Points, NDArray[np.float64]]:
    """Unit normals (zero where the area is) and areas."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    vectors = np.cross(b - a, c - a)
    double = _norm(vectors)
    return np.divide(vectors, double[:, None], out=np.zeros_like(vectors), where=double[:, None] > 0), double / 2


def _norm(vectors: Points) -> NDArray[np.float64]:
    lengths: NDArray[np.float64] = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    return lengths
