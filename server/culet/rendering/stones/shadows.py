"""Shadow volumes of a convex stone: for each light, the half-spaces that a shaded point of the room lies in.

A point outside a convex body is hidden from a light exactly when it lies inside the cone that the light spans over
the body's silhouette, and behind the body. The cone's sides are the planes through the light and each edge between a
lit and an unlit facet. Behind means inside all lit facets' half-spaces; that holds by itself for floor and walls that
have both the light and the whole stone in front of them, and is left out then.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def shadow_planes(planes: Array, vertices: Array, edges: NDArray[np.integer], light: Array, surfaces: Array) -> Array:
    """(N, 4) outward normals and offsets; a point is shaded if n.x <= d for all of them.

    planes (F, 4), vertices (V, 3), the light (3,) and surfaces (S, 4; the room is n.x >= d) share one frame; edges
    (E, 4) are rows of two vertices and the two facets that meet there. A light inside the stone has no lit facet, no
    plane, and so shades everything.
    """
    distance = planes[:, :3] @ light - planes[:, 3]
    lit = distance > 0
    silhouette = edges[lit[edges[:, 2]] != lit[edges[:, 3]]]
    a, b = vertices[silhouette[:, 0]] - light, vertices[silhouette[:, 1]] - light
    normals = _cross(a, b)
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals[lengths > 1e-12 * np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals *= np.where(normals @ light > 0, 1, -1)[:, None]  # the stone's centre, the origin, is inside
    sides = np.column_stack([normals, normals @ light])
    in_front = (vertices @ surfaces[:, :3].T >= surfaces[:, 3]).all() and (
        light @ surfaces[:, :3].T > surfaces[:, 3]
    ).all()
    return sides if in_front else np.vstack([sides, planes[lit]])


def _cross(a: Array, b: Array) -> Array:
    """(N, 3) cross products. `np.cross` takes ten times as long for some dozens, of which there are many a picture."""
    return a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]
