"""Does a surface cross itself? Every pair of triangles that may meet is found by a tree of boxes, and tested."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from culet.errors import TooLargeError
from culet.geometry.surface import Points, Triangles

DEPTH = 1e-6
"""Triangles cross if a side of one passes through the other with both ends farther than this from its plane, in units
of R. Less is what single precision makes of surfaces that only touch; more hides walls that pass through each other."""

PAIRS_LIMIT = 4_000_000
"""Box pairs looked at, at most, whatever the number of triangles: 0.6 s."""

PAIRS_PER_TRIANGLE = 60
"""Box pairs looked at for each triangle, at most, if that is more. A surface of triangles of like size needs 25."""

_INSIDE = 1e-9
"""How far outside a triangle, relative to its area, a side may pass and still count: sides meet sides in symmetric
shapes exactly."""

_CHUNK = 200_000
"""Pairs of triangles tested at once: 60 MiB."""

_BLOCK = 100_000
"""Pairs of boxes opened at once: 60 MiB."""


def crossing_triangles(vertices: Points, triangles: Triangles) -> tuple[int, int] | None:
    """The first pair found that crosses, or overlaps within one plane; None if there is none.

    TooLargeError if the triangles' boxes overlap so much that the search would not end in time.
    """
    corners = vertices[triangles]
    for pairs in _near_pairs(corners):
        for start in range(0, len(pairs), _CHUNK):
            some = pairs[start : start + _CHUNK]
            hit = _cross(corners, some) | _overlap(corners, some)
            if hit.any():
                a, b = some[int(hit.argmax())]
                return int(a), int(b)
    return None


def _near_pairs(corners: Points) -> Iterator[NDArray[np.int64]]:
    """(P, 2) pairs of triangles whose boxes overlap, from a complete binary tree along a space-filling curve."""
    count = len(corners)
    limit = max(PAIRS_LIMIT, PAIRS_PER_TRIANGLE * count)
    order = np.argsort(_morton(corners.mean(axis=1)), kind="stable")
    depth = max(1, int(np.ceil(np.log2(count))))
    low = np.full((1 << depth, 3), np.inf)
    high = np.full((1 << depth, 3), -np.inf)
    low[:count] = corners[order].min(axis=1) - DEPTH
    high[:count] = corners[order].max(axis=1) + DEPTH
    levels = [(low, high)]
    while len(levels[-1][0]) > 1:
        low, high = levels[-1]
        levels.append((np.minimum(low[::2], low[1::2]), np.maximum(high[::2], high[1::2])))
    # Depth first in blocks of pairs: the whole front of a level would take gigabytes where boxes overlap much.
    levels.reverse()
    waiting = [(0, np.zeros((1, 2), np.int64))]
    looked_at = 0
    while waiting:
        level, front = waiting.pop()
        if level == len(levels) - 1:
            yield order[front[front[:, 0] != front[:, 1]]]
            continue
        children = _children(front)
        looked_at += len(children)
        if looked_at > limit:
            raise TooLargeError(
                f"the mesh cannot be checked for crossing faces: its {count} triangles overlap one another's boxes "
                f"more than {limit} times; expected a surface whose triangles lie side by side"
            )
        low, high = levels[level + 1]
        a, b = children.T
        children = children[((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)]
        waiting += [(level + 1, children[k : k + _BLOCK]) for k in range(0, len(children), _BLOCK)]


def _children(front: NDArray[np.int64]) -> NDArray[np.int64]:
    """The pairs of a level below: a node with itself gives three, two nodes give four."""
    left, right = 2 * front[:, 0], 2 * front[:, 1]
    same = front[:, 0] == front[:, 1]
    pairs = [(left, right), (left, right + 1), (left + 1, right + 1), (left[~same] + 1, right[~same])]
    return np.concatenate([np.column_stack(pair) for pair in pairs])


def _morton(points: Points) -> NDArray[np.int64]:
    """Position along the Z-order curve, 20 bits an axis."""
    size = np.ptp(points, axis=0).max() or 1.0
    cells = ((points - points.min(axis=0)) / size * (2**20 - 1)).astype(np.int64)
    code = np.zeros(len(points), np.int64)
    for bit in range(20):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code


def _cross(corners: Points, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether a side of one triangle passes through the other. One that ends there, as at a common corner, does not."""
    hit = np.zeros(len(pairs), np.bool_)
    for one, other in (pairs.T, pairs.T[::-1]):
        normal, length = _normal(corners[one])
        height = np.einsum("ikj,ij->ik", corners[other] - corners[one, :1], normal)
        deep = DEPTH * length
        straddling = np.flatnonzero((height.min(axis=1) < -deep) & (height.max(axis=1) > deep) & ~hit)
        for k in range(3):
            ends = [k, (k + 1) % 3]
            p, q = height[straddling[:, None], ends].T
            through = (p * q < 0) & (np.minimum(abs(p), abs(q)) > deep[straddling])
            rows = straddling[through]
            p, q = height[rows[:, None], ends].T
            start, end = (corners[other[rows], side] for side in ends)
            point = start + (p / (p - q))[:, None] * (end - start)
            hit[rows] |= _within(corners[one[rows]], normal[rows], point)
    return hit


def _normal(shapes: Points) -> tuple[Points, NDArray[np.float64]]:
    """Of triangles (N, 3, 3): normals twice their area long, and those lengths."""
    normal = np.cross(shapes[:, 1] - shapes[:, 0], shapes[:, 2] - shapes[:, 0])
    return normal, np.sqrt(np.einsum("ij,ij->i", normal, normal))


def _within(shapes: Points, normal: Points, point: Points) -> NDArray[np.bool_]:
    """Whether points in the triangles' planes lie inside them or on their sides."""
    size = np.einsum("ij,ij->i", normal, normal)
    inside = np.ones(len(point), np.bool_)
    for k in range(3):
        side = shapes[:, (k + 1) % 3] - shapes[:, k]
        inside &= np.einsum("ij,ij->i", np.cross(side, point - shapes[:, k]), normal) >= -_INSIDE * size
    return inside


def _overlap(corners: Points, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether two triangles in one plane cover common ground: no side of either separates them."""
    first, second = corners[pairs[:, 0]], corners[pairs[:, 1]]
    normal, length = _normal(first)
    height = abs(np.einsum("ikj,ij->ik", second - first[:, :1], normal)).max(axis=1)
    rows = np.flatnonzero((height <= DEPTH * length) & (length > 0))
    hit = np.zeros(len(pairs), np.bool_)
    if not len(rows):
        return hit
    one, two = first[rows], second[rows]
    unit = normal[rows] / length[rows, None]
    apart = np.zeros(len(rows), np.bool_)
    for source in (one, two):
        for k in range(3):
            side = source[:, (k + 1) % 3] - source[:, k]
            outward = np.cross(side, unit)
            size = np.sqrt(np.einsum("ij,ij->i", outward, outward))
            ahead = [np.einsum("ikj,ij->ik", shape - source[:, k][:, None], outward) for shape in (one, two)]
            slack = DEPTH * size
            apart |= ahead[1].min(axis=1) >= ahead[0].max(axis=1) - slack
            apart |= ahead[0].min(axis=1) >= ahead[1].max(axis=1) - slack
            apart |= size == 0
    hit[rows] = ~apart
    return hit
