"""The shape of a stone: facets as half-spaces, surface as triangles, and its mass as the simulation needs it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Of a body of uniform density, about its centre of mass, in units of its circumradius R."""

    volume: float
    """R^3."""
    inertia: NDArray[np.float64]
    """(3, 3) tensor per unit of mass, R^2, in the shape's own axes."""


class FacetName(NamedTuple):
    """What a facet is called where the shape comes from."""

    tier: int
    """Counted from 1: facets of one angle and distance, cut one after the other."""
    name: str
    """May be empty."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A closed polyhedron, its centre at the origin and its farthest vertex at distance 1; y is up (table upward)."""

    name: str
    vertices: NDArray[np.float64]
    """(V, 3), all distinct."""
    triangles: NDArray[np.int32]
    """(T, 3) indices of vertices, counter-clockwise seen from outside."""
    facet_of_triangle: NDArray[np.int32]
    """(T,) index of the facet that the triangle belongs to; coplanar neighbours share one."""
    planes: NDArray[np.float64]
    """(F, 4) outward unit normal n and offset d of each facet: the inside is n.x <= d. If `convex`, the shape is their
    intersection."""
    convex: bool
    mass: MassProperties
    findings: tuple[str, ...] = ()
    """What was found in the source and what was done about it, a sentence each."""
    names: tuple[FacetName, ...] = ()
    """Of each facet, in the order of `planes`; none if they have no names, as in a mesh."""
