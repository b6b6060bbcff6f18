"""Inertia tensors per unit of mass, R^2, in the stone's axes (y is its axis of symmetry, table upward)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape

InertiaKind = Literal["polyhedron", "cone", "cone_apex"]

CONE_RADIUS = 1.0
"""R. The report's program; its text leaves R and h open."""
CONE_HEIGHT = 2.0
"""R."""


def cone_inertia(radius: float = CONE_RADIUS, height: float = CONE_HEIGHT) -> NDArray[np.float64]:
    """(3, 3) tensor of a solid cone about its centre of mass, which lies 3/4 of the height from the apex.

    3/80 (4 R^2 + h^2) across, 3/10 R^2 about the axis y.
    """
    across = 3 / 80 * (4 * radius**2 + height**2)
    return np.diag([across, 3 / 10 * radius**2, across])


def cone_apex_inertia(radius: float = CONE_RADIUS, height: float = CONE_HEIGHT) -> NDArray[np.float64]:
    """(3, 3) tensor of a solid cone about its apex: the report's formula (1), 3/20 (R^2 + 4 h^2) across.

    A free body turns about its centre of mass, so this one is too sluggish across the axis, by Steiner's (3 h / 4)^2,
    and is easiest to turn about the axis, where a real brilliant is hardest. (About its centre of mass, the cone with
    R = 1 and h = 2 has three equal moments and cannot wobble at all.)
    """
    across = 3 / 20 * (radius**2 + 4 * height**2)
    return np.diag([across, 3 / 10 * radius**2, across])


def inertia_tensor(kind: InertiaKind, shape: Shape) -> NDArray[np.float64]:
    """(3, 3) tensor per unit of mass that the scene's `simulation.inertia` names."""
    if kind == "polyhedron":
        return shape.mass.inertia
    if kind == "cone":
        return cone_inertia()
    return cone_apex_inertia()
