"""A convex shape from its facets' half-spaces alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError

from culet.errors import MeshError
from culet.geometry.assembly import assemble
from culet.geometry.polygons import fan, loops
from culet.geometry.shape import FacetName, Shape

SAME_VERTEX = 1e-9
"""Corners nearer than this, in units of the stone's extent, and joined by an edge are one. Rounding places the corners
of a needle of 1000:1 to about 1e-13; much larger would swallow real edges of a stone of 5000 facets (down to 1e-6)."""

LARGEST_NUMBER_OF_HALF_SPACES = 100_000


@dataclass(frozen=True, eq=False)
class Intersection:
    """A closed convex solid, where its half-spaces have it."""

    planes: NDArray[np.float64]
    """(F, 4) unit normals and offsets, as they were given."""
    vertices: NDArray[np.float64]
    """(V, 3)."""
    polygons: list[list[int]]
    """Of each half-space its corners, counter-clockwise seen from outside; none if it bounds nothing."""

    @property
    def used(self) -> list[int]:
        """The half-spaces that bound something."""
        return [k for k, polygon in enumerate(self.polygons) if len(polygon) >= 3]

    def shape(self, name: str, findings: Sequence[str] = (), names: Sequence[FacetName] = ()) -> Shape:
        """Centred at its centre of mass and scaled to circumradius 1; `names` has one for each half-space, or none."""
        used = self.used
        triangles, facet = fan([self.polygons[k] for k in used])
        return assemble(
            name, self.vertices, triangles, facet, self.planes[used],
            convex=True, findings=findings, names=[names[k] for k in used] if names else (),
        )  # fmt: skip


def shape_from_half_spaces(name: str, planes: NDArray[np.float64], names: Sequence[FacetName] = ()) -> Shape:
    """The intersection of half-spaces n.x <= d, centred at its centre of mass and scaled to circumradius 1.

    `planes` is (F, 4): outward normal n (of any length) and offset d. The shape's facets keep that order; half-spaces
    that bound nothing are left out and counted in the findings. MeshError if the intersection is empty, flat or open.
    """
    found = intersection(name, planes)
    left_out = len(found.planes) - len(found.used)
    findings = [f"{left_out} half-spaces bound nothing and were left out."] if left_out else []
    return found.shape(name, findings, names)


def intersection(name: str, planes: NDArray[np.float64]) -> Intersection:
    """The solid n.x <= d of (F, 4) outward normals n, of any length, and offsets d; MeshError as above."""
    given = np.asarray(planes, np.float64)
    if given.ndim != 2 or given.shape[1:] != (4,) or not 4 <= len(given) <= LARGEST_NUMBER_OF_HALF_SPACES:
        raise MeshError(
            f"{name}: expected 4 to {LARGEST_NUMBER_OF_HALF_SPACES} half-spaces of 4 numbers, got shape {given.shape}"
        )
    if not np.isfinite(given).all():
        raise MeshError(f"{name}: expected finite numbers, got {int((~np.isfinite(given)).sum())} that are not")
    length = np.linalg.norm(given[:, :3], axis=1)
    if not length.min() > 0:
        raise MeshError(f"{name}: half-space {int(length.argmin())} has a normal of length 0")
    unit = given / length[:, None]
    inside = _deepest_point(name, unit)
    vertices, polygons = _corners(name, unit, inside)
    return Intersection(unit, vertices, polygons)


def _deepest_point(name: str, unit: NDArray[np.float64]) -> NDArray[np.float64]:
    """Centre of the largest sphere that fits in: a linear programme (Chebyshev centre)."""
    rows = np.column_stack([unit[:, :3], np.ones(len(unit))])
    scale = float(np.abs(unit[:, 3]).max()) or 1.0  # the solver's tolerances are absolute, 1e-7
    answer = linprog([0, 0, 0, -1], A_ub=rows, b_ub=unit[:, 3] / scale, bounds=[(None, None)] * 4, method="highs")
    if answer.status == 3:
        raise MeshError(f"{name}: the half-spaces leave the stone open to infinity")
    if answer.status != 0:
        raise MeshError(f"{name}: the half-spaces enclose nothing that can be found ({answer.message})")
    if not answer.x[3] > 0:
        raise MeshError(f"{name}: no point lies inside all half-spaces (depth {answer.x[3] * scale:.3g})")
    point: NDArray[np.float64] = answer.x[:3] * scale
    return point


def _corners(
    name: str, unit: NDArray[np.float64], inside: NDArray[np.float64]
) -> tuple[NDArray[np.float64], list[list[int]]]:
    """Vertices, and each half-space's polygon (empty if it bounds nothing), by duality.

    Seen from an inner point, the plane n.x = d becomes the point n/d, and each facet of those points' convex hull is a
    corner of the stone; neighbouring facets of the hull are the ends of an edge of the stone.
    """
    depth = unit[:, 3] - unit[:, :3] @ inside
    # Rounding on thin stones may leave the point of the linear programme a hair outside; relative to the nearest plane
    # the dual points keep their order of magnitude.
    if not depth.min() > 0:
        raise MeshError(f"{name}: the half-spaces enclose nothing thicker than rounding")
    dual = unit[:, :3] / (depth / depth.min())[:, None]
    try:
        hull = ConvexHull(dual)
    except QhullError as error:
        raise MeshError(f"{name}: the half-spaces leave the stone open to infinity: a prism without ends") from error
    offset = hull.equations[:, 3]
    if not (offset < -1e-12).all():
        raise MeshError(f"{name}: the half-spaces leave the stone open to infinity")
    points = -hull.equations[:, :3] / offset[:, None]  # in units of the least depth, from `inside`

    simplices = hull.simplices.astype(np.int64)
    corners = dual[simplices]
    turn = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), points)
    simplices[turn < 0] = simplices[turn < 0][:, ::-1]

    # Each directed edge f -> g of a hull facet meets g -> f of the facet on its other side.
    count = len(unit)
    directed = np.concatenate([simplices[:, [0, 1]], simplices[:, [1, 2]], simplices[:, [2, 0]]])
    facet = np.tile(np.arange(len(simplices)), 3)
    key = directed[:, 0] * count + directed[:, 1]
    order = np.argsort(key)
    across = facet[order[np.searchsorted(key[order], directed[:, 1] * count + directed[:, 0])]]

    near = np.linalg.norm(points[facet] - points[across], axis=1) < SAME_VERTEX * np.ptp(points, axis=0).max()
    graph = coo_array((np.ones(near.sum()), (facet[near], across[near])), shape=(len(points), len(points)))
    number, label = connected_components(graph, directed=False)
    weight = np.bincount(label, minlength=number)
    vertices = np.column_stack([np.bincount(label, points[:, k], number) / weight for k in range(3)])

    start, end = label[across], label[facet]
    real = start != end
    polygons: list[list[int]] = [[] for _ in range(count)]
    by_plane = np.argsort(directed[real, 0], kind="stable")
    owner = directed[real, 0][by_plane]
    edges = np.column_stack([start[real], end[real]])[by_plane]
    bounds = np.searchsorted(owner, np.arange(count + 1))
    for plane in range(count):
        ring = edges[bounds[plane] : bounds[plane + 1]]
        if len(ring) < 3:
            continue
        closed = loops(ring)
        if closed is None or len(closed) != 1:
            raise MeshError(f"{name}: half-space {plane} meets the others in no simple polygon")
        polygons[plane] = closed[0]
    return inside + vertices * depth.min(), polygons
