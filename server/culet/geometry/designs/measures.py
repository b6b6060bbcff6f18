"""What a design's diagram prints: corners, edges, and proportions in per cent of the stone's width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from culet.geometry.designs.proportions import Proportions
from culet.geometry.designs.solid import Solid
from culet.geometry.half_spaces import Intersection
from culet.geometry.mass import solid_integrals
from culet.geometry.polygons import fan

Points = NDArray[np.float64]

SAME_CORNER = 1e-4
"""In units of the stone's extent. Files round angles to 0.01 degrees, so that facets that were cut to meet in a point
leave a cluster of corners, up to 9e-5 wide; the shortest edges that were meant are 2e-4."""


@dataclass(frozen=True, eq=False)
class DesignOutline:
    """Corners and faces as the designer meant them."""

    corners: Points
    """(V, 3), in the design's frame."""
    faces: tuple[tuple[int, ...], ...]
    """Of each of the solid's half-spaces its corners, counter-clockwise from outside; none if it is thinner than
    SAME_CORNER, or bounds nothing."""

    @property
    def edges(self) -> list[tuple[int, int]]:
        """Each once, the smaller number first."""
        sides = (side for face in self.faces for side in zip(face, face[1:] + face[:1], strict=True))
        return sorted({(min(side), max(side)) for side in sides})


def outline_of(cut: Intersection) -> DesignOutline:
    """Corners that are nearer to each other than SAME_CORNER made one."""
    points = cut.vertices
    near = KDTree(points).query_pairs(SAME_CORNER * float(np.ptp(points, axis=0).max()), output_type="ndarray")
    links = coo_array((np.ones(len(near)), (near[:, 0], near[:, 1])), shape=(len(points), len(points)))
    number, label = connected_components(links, directed=False)
    weight = np.bincount(label, minlength=number)
    corners = np.column_stack([np.bincount(label, points[:, k], number) / weight for k in range(3)])
    return DesignOutline(corners, tuple(_without_repeats([int(label[k]) for k in polygon]) for polygon in cut.polygons))


def proportions_of(solid: Solid) -> Proportions:
    """By the merged corners; the volume by the exact ones."""
    outline, planes = outline_of(solid.cut), solid.cut.planes
    points = outline.corners
    extent = np.ptp(points, axis=0)
    across = int(extent[1] < extent[0])
    width = float(extent[across])
    faces = [k for k, face in enumerate(outline.faces) if face]
    upright = points[sorted({corner for k in faces if planes[k, 2] == 0 for corner in outline.faces[k]}), 2]
    table = [k for k in faces if planes[k, 2] == 1]
    triangles, _ = fan([solid.cut.polygons[k] for k in solid.cut.used])
    return Proportions(
        facets=len(faces), corners=len({corner for face in outline.faces for corner in face}),
        edges=len(outline.edges), length=float(extent[1 - across]), width=width, height=float(extent[2]),
        volume=solid_integrals(solid.cut.vertices, triangles).volume,
        table_percent=100 * float(np.ptp(points[list(outline.faces[table[0]]), across])) / width if table else None,
        crown_percent=100 * float(points[:, 2].max() - upright.max()) / width if len(upright) else None,
        girdle_percent=100 * float(np.ptp(upright)) / width if len(upright) else None,
        pavilion_percent=100 * float(upright.min() - points[:, 2].min()) / width if len(upright) else None,
    )  # fmt: skip


def _without_repeats(corners: list[int]) -> tuple[int, ...]:
    """A loop whose neighbours differ; none if it has fewer than three corners left."""
    kept = [corner for place, corner in enumerate(corners) if corner != corners[place - 1]]
    return tuple(kept) if len(set(kept)) > 2 else ()
