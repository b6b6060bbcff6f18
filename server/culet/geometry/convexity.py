"""Is a closed surface convex? And if so: its facets and corners, from its hull."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from culet.errors import MeshError
from culet.geometry.facets import FLATNESS, bend, facets_of, neighbours, planes_of
from culet.geometry.mass import surface_area
from culet.geometry.polygons import fan, loops
from culet.geometry.surface import Points, Triangles

DENT = 2e-4
"""A surface that stays within this of its hull, in units of its mean thickness 3 V / A, is convex and the hull is
taken: coordinates of four digits leave such dents in every quad. Larger fills what was carved; smaller sends rounded
files of convex stones to the slower triangles, with creases in their facets."""

_CHUNK = 1 << 22
"""Products of vertices and planes held at once, 32 MiB."""


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """A convex surface with its facets."""

    vertices: Points
    triangles: NDArray[np.int32]
    facet_of_triangle: NDArray[np.int32]
    planes: NDArray[np.float64]
    """(F, 4), no vertex outside any."""
    dent: float
    """How deep the source lay below this surface, R."""


@dataclass(frozen=True)
class Dent:
    """Why a surface is not convex."""

    depth: float
    """R; of the deepest dent that was measured."""


def convex_form(vertices: Points, triangles: Triangles, volume: float) -> Polyhedron | Dent:
    """Decide, for a closed, outward wound surface of about unit radius.

    Three things together make it convex: no edge is concave, every vertex lies on the hull, and the volume is the
    hull's, each to within DENT. None alone would do: a fine, wide dimple has edges that are nearly flat, and a cube
    wound twice round itself has all its vertices on the hull.
    """
    area = surface_area(vertices, triangles)
    limit = max(FLATNESS, DENT * 3 * volume / area)
    _, corners = neighbours(triangles)
    edge = float(bend(vertices, corners).max(initial=0.0))
    if edge > limit:
        return Dent(edge)
    try:
        hull = ConvexHull(vertices)
    except QhullError as error:
        raise MeshError("the mesh is flat: its vertices lie in one plane") from error
    mean_depth = abs(float(hull.volume) - volume) / area
    if mean_depth > limit:
        return Dent(mean_depth)
    below = _deepest(vertices, hull, limit)
    if below > limit:
        return Dent(below)
    dent = max(edge, below)
    return _from_hull(vertices, hull, max(FLATNESS, 2 * dent), dent)


def _deepest(vertices: Points, hull: ConvexHull, limit: float) -> float:
    """How far below the hull its farthest vertex lies; stops early beyond the limit."""
    buried = np.ones(len(vertices), np.bool_)
    buried[hull.vertices] = False
    inner = vertices[buried]
    equations = np.unique(np.round(hull.equations, 12), axis=0)
    deepest = 0.0
    step = max(1, _CHUNK // len(equations))
    for start in range(0, len(inner), step):
        heights = inner[start : start + step] @ equations[:, :3].T + equations[:, 3]
        deepest = max(deepest, float(-heights.max(axis=1).min()))
        if deepest > limit:
            break
    return deepest


def _from_hull(vertices: Points, hull: ConvexHull, tolerance: float, dent: float) -> Polyhedron:
    simplices = hull.simplices.astype(np.int64)
    a, b, c = (vertices[simplices[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    simplices[inward] = simplices[inward][:, ::-1]
    facet = facets_of(vertices, simplices, tolerance)
    polygons = _polygons(simplices, facet)
    if polygons is None:  # facets that rounding ties into knots stay as the hull has them
        triangles, owner = simplices, facet.astype(np.int32)
    else:
        fans, owner = fan(polygons)
        triangles = fans.astype(np.int64)
    used, compact = np.unique(triangles, return_inverse=True)
    triangles, points = compact.reshape(-1, 3), vertices[used]
    planes = planes_of(vertices, simplices, facet, int(facet.max()) + 1)
    planes[:, 3] = _support(planes[:, :3], vertices, simplices, facet)
    own = np.full(len(planes), np.inf)
    np.minimum.at(own, owner, np.einsum("tkj,tj->tk", points[triangles], planes[owner, :3]).min(axis=1))
    gap = float((planes[:, 3] - own).max())
    if not gap <= 4 * tolerance:
        raise MeshError(f"the convex mesh is not the intersection of its facets: they stand off by {gap:.2g} R")
    return Polyhedron(points, triangles.astype(np.int32), owner, planes, dent)


def _support(normals: Points, vertices: Points, simplices: Triangles, facet: NDArray[np.int64]) -> NDArray[np.float64]:
    """(F,) the largest n.x over all vertices of a hull, for the normals of its own facets.

    From the facet's highest vertex uphill along edges: on a convex surface the first vertex without a higher neighbour
    is the highest of all. All facets climb together, one edge a round.
    """
    corner, owner = simplices.ravel(), np.repeat(facet, 3)
    height = np.einsum("ij,ij->i", vertices[corner], normals[owner])
    order = np.lexsort((height, owner))
    last = np.searchsorted(owner[order], np.arange(len(normals)), side="right") - 1
    at = corner[order[last]]
    top: NDArray[np.float64] = height[order[last]]
    edges = np.unique(np.concatenate([simplices[:, [0, 1]], simplices[:, [1, 2]], simplices[:, [2, 0]]]), axis=0)
    first = np.searchsorted(edges[:, 0], np.arange(len(vertices) + 1))
    climbing = np.arange(len(normals))
    while len(climbing):
        degree = first[at[climbing] + 1] - first[at[climbing]]
        begin = np.cumsum(degree) - degree
        step = np.arange(int(degree.sum())) - np.repeat(begin - first[at[climbing]], degree)
        neighbour = edges[step, 1]
        height = np.einsum("ij,ij->i", vertices[neighbour], normals[np.repeat(climbing, degree)])
        best = np.maximum.reduceat(height, begin)
        up = best > top[climbing]
        chosen = np.flatnonzero((height == np.repeat(best, degree)) & np.repeat(up, degree))
        at[np.repeat(climbing, degree)[chosen]] = neighbour[chosen]
        top[climbing] = np.maximum(top[climbing], best)
        climbing = climbing[up]
    return top


def _polygons(triangles: Triangles, facet: NDArray[np.int64]) -> list[list[int]] | None:
    """Each facet's corners in order: the ends of its boundary that at least three facets share.

    None if a facet's boundary is not one simple loop of three corners or more.
    """
    count = int(triangles.max()) + 1
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    owner = np.tile(facet, 3)
    key = directed[:, 0] * count + directed[:, 1]
    order = np.argsort(key)
    across = owner[order[np.searchsorted(key[order], directed[:, 1] * count + directed[:, 0])]]
    border = owner != across
    directed, owner = directed[border], owner[border]
    meeting = np.unique(np.column_stack([directed.ravel(), np.repeat(owner, 2)]), axis=0)
    corner = np.bincount(meeting[:, 0], minlength=count) >= 3
    order = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[order], np.arange(int(facet.max()) + 2))
    single = np.bincount(facet) == 1
    triangle_of = np.zeros(len(single), np.int64)
    triangle_of[facet] = np.arange(len(triangles))
    polygons = []
    for k in range(len(bounds) - 1):
        if single[k]:
            ring = [triangles[triangle_of[k]].tolist()]
        else:
            found = loops(directed[order[bounds[k] : bounds[k + 1]]])
            if found is None or len(found) != 1:
                return None
            ring = found
        polygon = [v for v in ring[0] if corner[v]]
        if len(polygon) < 3:
            return None
        polygons.append(polygon)
    return polygons
