"""Volume, centre of mass and inertia of a closed surface: the integral over its inside, exact for polyhedra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class SolidIntegrals:
    """Of the inside of a closed surface, uniform density 1."""

    volume: float
    """Negative if the surface is inside out."""
    centre: NDArray[np.float64]
    """(3,) centre of mass; the mean vertex where the volume is 0."""
    inertia: NDArray[np.float64]
    """(3, 3) tensor about the centre of mass, per unit of mass; zero where the volume is 0."""


def solid_integrals(vertices: NDArray[np.float64], triangles: NDArray[np.integer]) -> SolidIntegrals:
    """Sum the tetrahedra between each triangle and one common apex.

    Of a tetrahedron with one corner at the origin and the others at a, b, c, the volume is V = a.(b x c) / 6, the first
    moment V s / 4 and the second moment V (a a' + b b' + c c' + s s') / 20, where s = a + b + c (Tonon 2004, "Explicit
    exact formulas for the 3-D tetrahedron inertia tensor"). The apex is the mean vertex: far from the origin the terms
    would otherwise cancel.
    """
    apex = vertices.mean(axis=0)
    a, b, c = (vertices[triangles[:, corner]] - apex for corner in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    volume = float(volumes.sum())
    if volume == 0:
        return SolidIntegrals(0.0, apex, np.zeros((3, 3)))
    s = a + b + c
    offset = volumes @ s / (4 * volume)
    second = sum(np.einsum("i,ij,ik->jk", volumes, x, x) for x in (a, b, c, s)) / (20 * volume)
    covariance = second - np.outer(offset, offset)
    return SolidIntegrals(volume, apex + offset, np.trace(covariance) * np.eye(3) - covariance)


def surface_area(vertices: NDArray[np.float64], triangles: NDArray[np.integer]) -> float:
    """Sum of the triangles' areas."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
