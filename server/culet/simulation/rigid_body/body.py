"""A rigid body: mass and inertia, and what follows from them for a state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.geometry.shape import Shape
from culet.simulation.rigid_body.floor import sphere_gap
from culet.simulation.rigid_body.hull import Hull, hull_of
from culet.simulation.rigid_body.inertia import InertiaKind, inertia_tensor
from culet.simulation.rigid_body.principal_axes import PrincipalAxis, principal_axes
from culet.simulation.rigid_body.rotation import rotate, rotate_back
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, RigidState, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, Surface

MatrixRows = tuple[Triple, Triple, Triple]


@dataclass(frozen=True, eq=False)
class RigidBody:
    """What a motion model needs to know of the stone besides its state."""

    shape: Shape
    mass: float
    inertia: MatrixRows
    """About the centre of mass in the stone's axes, mass R^2."""
    inverse_inertia: MatrixRows
    """1 / (mass R^2)."""
    surfaces: tuple[Surface, ...] = (FLOOR,)
    """What stops it."""

    @classmethod
    def of(cls, settings: SimulationSettings, shape: Shape, surfaces: tuple[Surface, ...] = (FLOOR,)) -> Self:
        """The body of that stone between these surfaces; InputError if its inertia tensor is none."""
        return cls(shape, settings.mass, *inertia_of(settings.inertia, shape, settings.mass), surfaces)

    @cached_property
    def hull(self) -> Hull:
        """The vertices that can touch a plane."""
        return hull_of(self.shape)

    @cached_property
    def principal_axes(self) -> tuple[PrincipalAxis, PrincipalAxis, PrincipalAxis]:
        """Directions in the stone's axes with their moments, the smallest first."""
        return principal_axes(self.inertia)

    def fastest_turn(self, orientation: Quaternion, angular_momentum: Triple) -> float:
        """The highest angular speed, rad/s, that a free rotation from here passes through, or a little more.

        |omega|^2 = sum x_i / I_i^2 where the squares x_i = L_i^2 >= 0 have sum x_i = L^2 and sum x_i / I_i = 2 E: a
        linear programme, whose maximum has no more than two x_i that are not 0. |L| / I1 would be 10^6 times too much
        for a needle that turns over.
        """
        x, y, z = angular_momentum
        squared = x * x + y * y + z * z
        if squared == 0:
            return 0.0
        wx, wy, wz = self.angular_velocity_at(orientation, angular_momentum)
        twice_energy = x * wx + y * wy + z * wz
        moments = [axis.moment for axis in self.principal_axes]
        fastest = wx * wx + wy * wy + wz * wz
        for i, j in ((0, 1), (0, 2), (1, 2)):
            difference = 1 / moments[i] - 1 / moments[j]
            if difference > 0:
                share = (twice_energy - squared / moments[j]) / difference
                if -1e-9 * squared <= share <= (1 + 1e-9) * squared:
                    share = min(max(share, 0.0), squared)
                    fastest = max(fastest, share / moments[i] ** 2 + (squared - share) / moments[j] ** 2)
        return math.sqrt(fastest)

    def velocity(self, state: RigidState) -> Triple:
        """Of the centre of mass, R/s."""
        x, y, z = state.momentum
        return (x / self.mass, y / self.mass, z / self.mass)

    def angular_velocity(self, state: RigidState) -> Triple:
        """In world axes, rad/s."""
        return self.angular_velocity_at(state.orientation, state.angular_momentum)

    def angular_velocity_at(self, orientation: Quaternion, angular_momentum: Triple) -> Triple:
        """In world axes, rad/s: L turned into the stone's axes, through its inverse tensor, and back."""
        return rotate(orientation, _apply(self.inverse_inertia, rotate_back(orientation, angular_momentum)))

    def angular_momentum(self, orientation: Quaternion, omega: Triple) -> Triple:
        """Of that angular velocity (world axes, rad/s), in world axes, mass R^2/s."""
        return angular_momentum_of(self.inertia, orientation, omega)

    def energy(self, state: RigidState, gravity: float) -> float:
        """Kinetic and potential, mass R^2/s^2; the latter is 0 where the bounding sphere touches the floor."""
        p, angular, omega = state.momentum, state.angular_momentum, self.angular_velocity(state)
        linear = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / (2 * self.mass)
        rotational = 0.5 * (angular[0] * omega[0] + angular[1] * omega[1] + angular[2] * omega[2])
        return linear + rotational + self.mass * gravity * sphere_gap(state.position)


def inertia_of(kind: InertiaKind, shape: Shape, factor: float) -> tuple[MatrixRows, MatrixRows]:
    """The tensor that a scene names, and its inverse, of a shape of R = 1 and a mass of 1, times a factor.

    The factor of a placed stone is its mass times its scale squared. InputError if the tensor is none.
    """
    per_mass = _rows(inertia_tensor(kind, shape))
    return _scaled(per_mass, factor), _scaled(_inverse(per_mass), 1 / factor)


def angular_momentum_of(inertia: MatrixRows, orientation: Quaternion, omega: Triple) -> Triple:
    """Of a body with that tensor in its own axes, in world axes."""
    return rotate(orientation, _apply(inertia, rotate_back(orientation, omega)))


def _apply(rows: MatrixRows, v: Triple) -> Triple:
    (a, b, c), (d, e, f), (g, h, i) = rows
    x, y, z = v
    return (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z)


def _scaled(rows: MatrixRows, factor: float) -> MatrixRows:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (
        (a * factor, b * factor, c * factor),
        (d * factor, e * factor, f * factor),
        (g * factor, h * factor, i * factor),
    )


def _rows(tensor: NDArray[np.float64]) -> MatrixRows:
    if tensor.shape != (3, 3):
        raise InputError(f"an inertia tensor is 3 by 3; got shape {tensor.shape}")
    if not np.isfinite(tensor).all():
        raise InputError(f"an inertia tensor is finite; got {tensor.tolist()}")
    # trimesh's tensor is symmetric only to rounding; an inverse that is not would create angular momentum
    (a, b, c), (_, e, f), (_, _, i) = ((tensor + tensor.T) / 2).tolist()
    if float(np.abs(tensor - tensor.T).max()) > 1e-9 * max(a, e, i):
        raise InputError(f"an inertia tensor is symmetric; got {tensor.tolist()}")
    return ((a, b, c), (b, e, f), (c, f, i))


def _inverse(rows: MatrixRows) -> MatrixRows:
    """Of a symmetric positive definite tensor, by cofactors in plain floats: the same bits on every processor.

    Moments of inertia obey I1 + I2 >= I3, so at most one of them is small and the determinant keeps its digits as well
    as an elimination would: its relative error is the condition number's, not that number's square.
    """
    (a, b, c), (_, e, f), (_, _, i) = rows
    minor = a * e - b * b
    xx, xy, xz = e * i - f * f, c * f - b * i, b * f - c * e
    determinant = a * xx + b * xy + c * xz
    if not (a > 0 and minor > 0 and determinant > 0):  # Sylvester's criterion
        raise InputError(f"an inertia tensor is positive definite; got {rows}")
    yy, yz = a * i - c * c, b * c - a * f
    return _scaled(((xx, xy, xz), (xy, yy, yz), (xz, yz, minor)), 1 / determinant)
