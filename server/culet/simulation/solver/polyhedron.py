"""A stone's convex hull with its faces and edges: what several stones touch each other with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from culet.geometry.facets import FLATNESS, facets_of, planes_of
from culet.geometry.polygons import loops
from culet.geometry.shape import Shape
from culet.simulation.rigid_body.hull import hull_of
from culet.simulation.solver.interface import MAX_VERTICES

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SolverHull:
    """Convex, about the stone's centre of mass, R = 1."""

    vertices: Points
    """(V, 3), V at most 1024."""
    planes: Points
    """(F, 4) outward unit normals, and offsets that leave no vertex outside."""
    first: NDArray[np.int32]
    """(F + 1,) where each face's corners begin."""
    corners: NDArray[np.int32]
    """Vertices about each face, counter-clockwise seen from outside."""
    edges: NDArray[np.int32]
    """(E, 4) both ends and both faces."""
    thinned: float = 0.0
    """R. By how much the stone's hull is beyond this one, which has fewer vertices; 0: it is the stone's."""

    @classmethod
    def of(cls, points: Points, most: int = MAX_VERTICES) -> Self:
        """The hull of (N, 3) points that are not all in one plane, of at most `most` of them."""
        chosen = points if len(points) <= most else points[_spread(points, most)]
        hull = ConvexHull(chosen)
        vertices = chosen[hull.vertices]
        vertices = np.ascontiguousarray(vertices[np.lexsort(vertices.T[::-1])])  # one order, whatever theirs was
        hull = ConvexHull(vertices)
        triangles = _outward(vertices, hull.simplices.astype(np.int64))
        facet = facets_of(vertices, triangles, FLATNESS)
        faces, facet = _polygons(triangles, facet)
        normals = planes_of(vertices, triangles, facet, len(faces))[:, :3]
        offsets = (vertices @ normals.T).max(axis=0)
        beyond = 0.0
        if len(chosen) < len(points):  # one by one: all together would be hundreds of megabytes
            beyond = max(float((points @ n).max()) - d for n, d in zip(normals, offsets.tolist(), strict=True))
        return cls(
            vertices=vertices,
            planes=np.ascontiguousarray(np.column_stack([normals, offsets])),
            first=np.cumsum([0, *map(len, faces)], dtype=np.int32),
            corners=np.concatenate(faces).astype(np.int32),
            edges=_edges(faces),
            thinned=beyond,
        )


_POLYHEDRA: WeakKeyDictionary[Shape, SolverHull] = WeakKeyDictionary()


def polyhedron_of(shape: Shape) -> SolverHull:
    """The stone's, computed once."""
    found = _POLYHEDRA.get(shape)
    if found is None:
        found = _POLYHEDRA[shape] = SolverHull.of(np.array(hull_of(shape).points))
    return found


def _spread(points: Points, count: int) -> NDArray[np.int64]:
    """So many of the points, each the farthest from those before (Gonzalez 1985), the first the farthest out."""
    x, y, z = (np.ascontiguousarray(points[:, axis]) for axis in range(3))
    chosen = np.empty(count, np.int64)
    chosen[0] = np.argmax(x * x + y * y + z * z)
    distance = np.full(len(points), np.inf)
    for k in range(1, count):
        last = chosen[k - 1]
        np.minimum(distance, (x - x[last]) ** 2 + (y - y[last]) ** 2 + (z - z[last]) ** 2, out=distance)
        chosen[k] = np.argmax(distance)
    return chosen


def _outward(vertices: Points, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """The hull's triangles, counter-clockwise seen from outside."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - vertices.mean(axis=0)) < 0
    triangles[inward] = triangles[inward, ::-1]
    return triangles


def _polygons(triangles: NDArray[np.int64], facet: NDArray[np.int64]) -> tuple[list[list[int]], NDArray[np.int64]]:
    """Corners about each facet, and the facet of each triangle: one whose boundary is no simple loop is taken apart."""
    faces: list[list[int]] = []
    label = np.empty_like(facet)
    for number in np.unique(facet).tolist():
        own = np.flatnonzero(facet == number)
        polygon = _boundary(triangles[own])
        if polygon is not None:
            label[own] = len(faces)
            faces.append(polygon)
            continue
        for triangle in own.tolist():
            label[triangle] = len(faces)
            faces.append(triangles[triangle].tolist())
    return faces, label


def _boundary(triangles: NDArray[np.int64]) -> list[int] | None:
    """Corners of what triangles cover together, or None if that has no simple boundary."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    directed = set(map(tuple, sides.tolist()))
    outer = [(a, b) for a, b in sides.tolist() if (b, a) not in directed]
    found = loops(np.array(outer, np.int64).reshape(-1, 2))
    return found[0] if found is not None and len(found) == 1 else None


def _edges(faces: list[list[int]]) -> NDArray[np.int32]:
    owner = {
        (a, b): number for number, face in enumerate(faces) for a, b in zip(face, face[1:] + face[:1], strict=True)
    }
    return np.array([(a, b, left, owner[b, a]) for (a, b), left in owner.items() if a < b], np.int32)
