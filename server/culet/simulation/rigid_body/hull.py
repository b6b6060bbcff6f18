"""The vertices of a stone's convex hull: all that can touch a plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from culet.geometry.shape import Shape
from culet.simulation.rigid_body.state import Triple


@dataclass(frozen=True, eq=False)
class Hull:
    """In one order whatever the order they came in, so that sums over contacts are the same to the bit."""

    points: tuple[Triple, ...]
    """V vertices in the stone's axes, R."""
    coordinates: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    """The same as three (V,) arrays."""
    radius: float
    """Of the sphere about the centre of mass that holds them all, R."""

    @classmethod
    def of(cls, vertices: NDArray[np.float64]) -> Self:
        """The hull of (N, 3) vertices that are not all in one plane."""
        corners = vertices[ConvexHull(vertices).vertices]
        corners = corners[np.lexsort(corners.T[::-1])]
        x, y, z = (np.ascontiguousarray(corners[:, axis]) for axis in range(3))
        radius = float(np.sqrt(x * x + y * y + z * z).max())
        return cls(tuple((a, b, c) for a, b, c in corners.tolist()), (x, y, z), radius)

    def heights(self, direction: Triple) -> NDArray[np.float64]:
        """(V,) of the vertices along a direction in the stone's axes; sums in one order, without BLAS."""
        x, y, z = self.coordinates
        return x * direction[0] + y * direction[1] + z * direction[2]


_HULLS: WeakKeyDictionary[Shape, Hull] = WeakKeyDictionary()
"""Of 41 000 vertices one takes half a second, and every change of mass, walls or height would need it again."""


def hull_of(shape: Shape) -> Hull:
    """The shape's hull, computed once."""
    hull = _HULLS.get(shape)
    if hull is None:
        hull = _HULLS[shape] = Hull.of(shape.vertices)
    return hull
