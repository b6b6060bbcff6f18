"""The last step of every way to a shape: centre it, scale it to circumradius 1, integrate its mass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError
from culet.geometry.mass import solid_integrals
from culet.geometry.shape import FacetName, MassProperties, Shape

Centre = Literal["mass", "vertex_mean"]
"""What becomes the origin: the centre of mass, or the mean of the vertices as in the report's program."""


def assemble(
    name: str,
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int32],
    facet_of_triangle: NDArray[np.int32],
    planes: NDArray[np.float64],
    *,
    convex: bool,
    centre: NDArray[np.float64] | None = None,
    findings: Sequence[str] = (),
    names: Sequence[FacetName] = (),
) -> Shape:
    """The shape of a closed, outward wound surface in any position and size.

    `centre` is the point that becomes the origin; without it, the centre of mass. MeshError if there is no volume.
    """
    integrals = solid_integrals(vertices, triangles)
    if not integrals.volume > 0:
        raise MeshError(f"{name}: expected a solid, got a surface of volume {integrals.volume:.3g}")
    origin = integrals.centre if centre is None else centre
    moved = vertices - origin
    radius = float(np.sqrt((moved * moved).sum(axis=1).max()))
    placed = planes.copy()
    placed[:, 3] = (planes[:, 3] - planes[:, :3] @ origin) / radius
    arrays = (
        np.ascontiguousarray(moved / radius),
        np.ascontiguousarray(triangles, np.int32),
        np.ascontiguousarray(facet_of_triangle, np.int32),
        placed,
    )
    inertia = integrals.inertia / radius**2
    for array in (*arrays, inertia):
        array.setflags(write=False)  # shapes are shared: a cache gives the same one to every session
    mass = MassProperties(volume=integrals.volume / radius**3, inertia=inertia)
    return Shape(name, *arrays, convex=convex, mass=mass, findings=tuple(findings), names=tuple(names))
