"""Flat polygons that were cut into triangles badly, cut again.

Readers fan polygons from their first corner. On a concave polygon some of those triangles fold over others, on three
corners in a line some have no area; the surface is closed all the same, but it covers ground twice or has cracks that
only rounding hides. Both are repaired from the polygon's boundary, by clipping ears.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from culet.geometry.facets import FLATNESS, bend, neighbours
from culet.geometry.polygons import loops
from culet.geometry.surface import Points, Triangles

LARGEST_POLYGON = 2000
"""Corners; clipping takes the square of it, 0.6 s. What is larger stays as it is, and is refused if it folds."""

CLIPPING_LIMIT = 10 * LARGEST_POLYGON**2
"""Sum of the squares of all polygons' corners: some seconds. What is beyond stays as it is."""


def retriangulated(vertices: Points, triangles: Triangles) -> tuple[Triangles, int]:
    """The surface with its badly cut flat polygons cut again, and how many there were.

    A region whose boundary is not one simple loop, or that has corners inside, stays as it is.
    """
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area_vectors = np.cross(b - a, c - a)
    double = np.linalg.norm(area_vectors, axis=1)
    longest = np.sqrt(np.max([((v - u) ** 2).sum(axis=1) for u, v in ((a, b), (b, c), (c, a))], axis=0))
    empty = double <= FLATNESS * longest
    pair, corners = neighbours(triangles)
    flat = abs(bend(vertices, corners)) <= FLATNESS
    folded = flat & (np.einsum("ij,ij->i", area_vectors[pair[:, 0]], area_vectors[pair[:, 1]]) < 0)
    folded &= ~empty[pair].any(axis=1)
    bad = empty.copy()
    bad[pair[folded]] = True
    if not bad.any():
        return triangles, 0
    count = len(triangles)
    # An empty triangle is flat with everything about it; it belongs to the polygon across its longest side.
    side = np.sqrt(((vertices[corners[:, 0]] - vertices[corners[:, 1]]) ** 2).sum(axis=1))
    own = side[:, None] >= longest[pair] * (1 - 1e-9)
    linked = pair[flat & (own | ~empty[pair]).all(axis=1)]
    _, label = connected_components(coo_array((np.ones(len(linked)), linked.T), shape=(count, count)), directed=False)
    keep = np.ones(count, np.bool_)
    fresh: list[NDArray[np.int64]] = []
    order = np.argsort(label, kind="stable")
    bounds = np.searchsorted(label[order], np.arange(int(label.max()) + 2))
    spent = 0
    for k in np.unique(label[bad]).tolist():
        region = order[bounds[k] : bounds[k + 1]]
        spent += (len(region) + 2) ** 2
        if spent > CLIPPING_LIMIT:
            break
        clipped = _cut_again(vertices, triangles[region])
        if clipped is not None:
            keep[region] = False
            fresh.append(clipped)
    return np.concatenate([triangles[keep], *fresh]), len(fresh)


def _cut_again(vertices: Points, region: Triangles) -> NDArray[np.int64] | None:
    directed = np.concatenate([region[:, [0, 1]], region[:, [1, 2]], region[:, [2, 0]]])
    count = int(directed.max()) + 1
    key, reverse = directed[:, 0] * count + directed[:, 1], directed[:, 1] * count + directed[:, 0]
    rings = loops(directed[~np.isin(key, reverse)])
    if rings is None or len(rings) != 1:
        return None
    ring = rings[0]
    if not 3 <= len(ring) <= LARGEST_POLYGON or len(region) != len(ring) - 2:
        return None  # a corner inside, or a handle
    points = vertices[ring]
    around = np.cross(points - points[0], np.roll(points, -1, axis=0) - points[0]).sum(axis=0)
    length = float(np.linalg.norm(around))
    if length <= FLATNESS:
        return None
    normal = around / length
    if abs((points - points.mean(axis=0)) @ normal).max() > FLATNESS * 10:
        return None
    x_axis = np.cross(normal, np.eye(3)[abs(normal).argmin()])
    x_axis /= np.linalg.norm(x_axis)
    plane = np.column_stack([points @ x_axis, points @ np.cross(normal, x_axis)])
    ears = clip_ears(plane)
    return None if ears is None else np.array(ring)[ears]


def clip_ears(polygon: NDArray[np.float64]) -> NDArray[np.int64] | None:
    """(N - 2, 3) triangles of a simple polygon (N, 2), counter-clockwise; None if no ear is left on the way.

    Of all ears the one with the largest least height goes first, so that corners in a line end in triangles with area.
    """
    left = list(range(len(polygon)))
    ears: list[tuple[int, int, int]] = []
    quality = [_ear(polygon, left, k) for k in range(len(left))]
    while len(left) > 3:
        best = int(np.argmax(quality))
        if quality[best] <= 0:
            return None
        size = len(left)
        ears.append((left[best - 1], left[best], left[(best + 1) % size]))
        del left[best], quality[best]
        for k in ((best - 1) % len(left), best % len(left)):
            quality[k] = _ear(polygon, left, k)
    ears.append((left[0], left[1], left[2]))
    if _height(*polygon[left]) <= 0:
        return None
    return np.array(ears, np.int64)


def _ear(polygon: NDArray[np.float64], left: list[int], k: int) -> float:
    """Least height of the triangle at corner k, or 0 if it is no ear: reflex, flat, or not empty."""
    before, here, after = left[k - 1], left[k], left[(k + 1) % len(left)]
    p, q, r = polygon[before], polygon[here], polygon[after]
    height = _height(p, q, r)
    if height <= 1e-12:
        return 0.0
    others = polygon[[i for i in left if i not in (before, here, after)]]
    inside = np.ones(len(others), np.bool_)
    for u, v in ((p, q), (q, r), (r, p)):
        inside &= (v[0] - u[0]) * (others[:, 1] - u[1]) - (v[1] - u[1]) * (others[:, 0] - u[0]) >= 0
    return 0.0 if inside.any() else height


def _height(p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]) -> float:
    """Least height of a triangle, negative if it is clockwise."""
    double = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    longest = max(np.hypot(*(q - p)), np.hypot(*(r - q)), np.hypot(*(p - r)))
    return float(double / longest) if longest > 0 else 0.0
