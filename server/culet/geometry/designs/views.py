"""A design seen from its four sides, as line drawings have it: parallel light, faces that look at the viewer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.geometry.designs.measures import DesignOutline
from culet.geometry.designs.solid import Solid

Points = NDArray[np.float64]

EDGE_ON = 1e-9
"""Cosine between a face and the way to the viewer below which the face is seen from its edge."""


@dataclass(frozen=True)
class ViewSide:
    """Where a viewer stands: what of the design's frame is right, up, and toward the viewer, a right-handed triple."""

    name: str
    right: tuple[int, int, int]
    up: tuple[int, int, int]
    toward: tuple[int, int, int]


ABOVE = ViewSide("From above", (1, 0, 0), (0, 1, 0), (0, 0, 1))
"""Index 0 is up; a positive wheel counts clockwise."""
BELOW = ViewSide("From below", (-1, 0, 0), (0, 1, 0), (0, 0, -1))
"""Index 0 is up; a positive wheel counts counter-clockwise."""
FRONT = ViewSide("From the front", (1, 0, 0), (0, 0, 1), (0, -1, 0))
END = ViewSide("From the end", (0, 1, 0), (0, 0, 1), (1, 0, 0))


@dataclass(frozen=True, eq=False)
class Face:
    """A face that a viewer sees."""

    name: str
    """May be empty."""
    tier: int
    """Counted from 1."""
    corners: Points
    """(N, 2), right and up, counter-clockwise."""
    middle: Points
    """(2,) of its area."""
    room: float
    """How far its nearest side is from its middle."""


def faces_seen(solid: Solid, outline: DesignOutline, side: ViewSide) -> list[Face]:
    """The faces that look at the viewer: of a convex solid all of each, and nothing else, is seen."""
    axes = np.array([side.right, side.up], np.float64).T
    facing = solid.cut.planes[:, :3] @ side.toward
    return [
        _face(solid.facets[k][1].name, solid.facets[k][0], outline.corners[list(face)] @ axes)
        for k, face in enumerate(outline.faces)
        if face and facing[k] > EDGE_ON
    ]


def _face(name: str, tier: int, corners: Points) -> Face:
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
    area = cross.sum() / 2
    middle = corners.mean(axis=0) if area == 0 else ((corners + following) * cross[:, None]).sum(axis=0) / (6 * area)
    sides = following - corners
    lengths = np.hypot(*sides.T)
    away = abs(sides[:, 0] * (middle - corners)[:, 1] - sides[:, 1] * (middle - corners)[:, 0])
    heights = np.divide(away, lengths, out=np.zeros_like(away), where=lengths > 0)
    return Face(name, tier, corners, middle, float(heights.min()))
