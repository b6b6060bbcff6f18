"""Free rotation: how the orientation follows from a constant angular momentum.

    q' = (0, omega) q / 2,   omega = R I^-1 R^T L,   L constant

Gravity has no moment about the centre of mass, so that this is the whole of flight besides a parabola. All methods keep
L to the bit, since it is the state; they differ in how well q, and with it the energy, follows. The default is RKMK4: a
classical Runge-Kutta step not on q but on the Gibbs vector u (rotation axis times the tangent of half the angle) of the
turn since the step began, which q = (1, u) q0 / |(1, u)| maps back to a rotation (Munthe-Kaas 1998, with the Cayley
map in place of the exponential):

    u' = (omega + omega x u + (omega . u) u) / 2,   u(0) = 0

It takes neither sine nor cosine, so that it gives the same bits on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.principal_axes import PrincipalAxis
from culet.simulation.rigid_body.rotation import euler_step, normalised, product, rotate_back
from culet.simulation.rigid_body.state import Quaternion, Triple

MAX_TURN = 0.125
"""rad. A longer step is divided. Larger: less work at high spin, less exact (by the fourth power)."""
STIFF = 20.0
"""Ratio of the largest to the smallest moment. Beyond, a Runge-Kutta step's error of the axis, divided by the smallest
moment, becomes a spin that was never there; `symmetric_top` takes over, which cannot make that error."""
MAX_DIVISIONS = 64
"""Of one step. A stone that turns by more than MAX_TURN times this is drawn at random anyway; see `turned`."""

Integrator = Callable[[RigidBody, Quaternion, Triple, float], Quaternion]


def rkmk4(body: RigidBody, q: Quaternion, angular_momentum: Triple, h: float) -> Quaternion:
    """Fourth order."""
    first = _gibbs_rate(body, q, angular_momentum, (0.0, 0.0, 0.0))
    second = _gibbs_rate(body, q, angular_momentum, _times(first, h / 2))
    third = _gibbs_rate(body, q, angular_momentum, _times(second, h / 2))
    fourth = _gibbs_rate(body, q, angular_momentum, _times(third, h))
    x, y, z = (h / 6 * (a + 2 * (b + c) + d) for a, b, c, d in zip(first, second, third, fourth, strict=True))
    return _cayley(q, (x, y, z))


def rk4(body: RigidBody, q: Quaternion, angular_momentum: Triple, h: float) -> Quaternion:
    """Classical Runge-Kutta on the four numbers of the quaternion, normalised at the end. Fourth order."""
    first = _quaternion_rate(body, q, angular_momentum)
    second = _quaternion_rate(body, _along(q, first, h / 2), angular_momentum)
    third = _quaternion_rate(body, _along(q, second, h / 2), angular_momentum)
    fourth = _quaternion_rate(body, _along(q, third, h), angular_momentum)
    w, x, y, z = (
        at + h / 6 * (a + 2 * (b + c) + d) for at, a, b, c, d in zip(q, first, second, third, fourth, strict=True)
    )
    return normalised((w, x, y, z))


def midpoint(body: RigidBody, q: Quaternion, angular_momentum: Triple, h: float) -> Quaternion:
    """Explicit Lie midpoint: half an Euler step, then a whole one with the angular velocity found there. 2nd order."""
    half = _cayley(q, _times(body.angular_velocity_at(q, angular_momentum), h / 4))
    return _cayley(q, _times(body.angular_velocity_at(half, angular_momentum), h / 2))


def euler(body: RigidBody, q: Quaternion, angular_momentum: Triple, h: float) -> Quaternion:
    """As the report's program: one explicit Euler step of the quaternion. First order; energy drifts."""
    return euler_step(q, body.angular_velocity_at(q, angular_momentum), h)


def splitting(body: RigidBody, q: Quaternion, angular_momentum: Triple, h: float) -> Quaternion:
    """Exact turns about one principal axis after the other: 1 2 3 2 1 (Touma and Wisdom 1994). 2nd order, symplectic.

    The kinetic energy is a sum of one term for each axis, and each term's motion alone is a uniform turn.
    """
    axes = body.principal_axes
    for axis, part in ((0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)):
        direction, moment = axes[axis]
        q = product(q, _turn(direction, _along_axis(q, angular_momentum, direction) / moment * part * h))
    return normalised(q)


def symmetric_top(body: RigidBody, q: Quaternion, angular_momentum: Triple, h: float) -> Quaternion:
    """Exact for a body with two equal moments; for others the rest is split off, by `splitting`'s turns. Second order.

    With 1/I the same across an axis, the motion is a turn about L at L / I, and one about the axis at what is left.
    """
    smallest, middle, largest = body.principal_axes
    if 1 / smallest.moment - 1 / middle.moment > 1 / middle.moment - 1 / largest.moment:
        axis, one, other = smallest, middle, largest
    else:
        axis, one, other = largest, smallest, middle
    across = (1 / one.moment + 1 / other.moment) / 2
    rest = 1 / one.moment - across
    q = _top_turn(q, angular_momentum, axis, across, h / 2)
    if rest * math.hypot(*angular_momentum) * h > 1e-15:
        for turn, part in ((one, 0.5), (other, -1.0), (one, 0.5)):
            along = _along_axis(q, angular_momentum, turn.direction)
            q = product(q, _turn(turn.direction, along * rest * part * h))
    return normalised(_top_turn(q, angular_momentum, axis, across, h / 2))


def _top_turn(q: Quaternion, angular_momentum: Triple, axis: PrincipalAxis, across: float, time: float) -> Quaternion:
    along = _along_axis(q, angular_momentum, axis.direction)
    q = product(q, _turn(axis.direction, along * (1 / axis.moment - across) * time))
    length = math.hypot(*angular_momentum)
    return product(_turn(_times(angular_momentum, 1 / length), length * across * time), q) if length > 0 else q


def _along_axis(q: Quaternion, angular_momentum: Triple, direction: Triple) -> float:
    x, y, z = rotate_back(q, angular_momentum)
    return x * direction[0] + y * direction[1] + z * direction[2]


def _turn(direction: Triple, angle: float) -> Quaternion:
    sine = math.sin(angle / 2)
    return (math.cos(angle / 2), sine * direction[0], sine * direction[1], sine * direction[2])


INTEGRATORS: dict[str, Integrator] = {
    "rkmk4": rkmk4, "rk4": rk4, "midpoint": midpoint, "splitting": splitting,
    "symmetric_top": symmetric_top, "euler": euler,
}  # fmt: skip


def turned(body: RigidBody, q: Quaternion, angular_momentum: Triple, time: float, integrator: Integrator) -> Quaternion:
    """The orientation after `time` seconds of free rotation, in as few steps as MAX_TURN allows.

    Beyond MAX_DIVISIONS of them the stone is turned about its angular momentum instead, which keeps momentum and energy
    exactly and leaves out how the axis wanders in the stone.
    """
    if angular_momentum == (0.0, 0.0, 0.0):
        return q
    divisions = 1
    if math.hypot(*angular_momentum) * time > MAX_TURN * body.principal_axes[0].moment:  # else no turn can be longer
        divisions = math.ceil(body.fastest_turn(q, angular_momentum) * time / MAX_TURN)
    if divisions > MAX_DIVISIONS:
        return _about_angular_momentum(body, q, angular_momentum, time)
    if body.principal_axes[2].moment > STIFF * body.principal_axes[0].moment:
        integrator = symmetric_top
    for _ in range(divisions):
        q = integrator(body, q, angular_momentum, time / divisions)
    return q


def _about_angular_momentum(body: RigidBody, q: Quaternion, angular_momentum: Triple, time: float) -> Quaternion:
    length = math.hypot(*angular_momentum)
    axis = _times(angular_momentum, 1 / length)
    x, y, z = body.angular_velocity_at(q, angular_momentum)
    return normalised(product(_turn(axis, (x * axis[0] + y * axis[1] + z * axis[2]) * time), q))


def _gibbs_rate(body: RigidBody, q: Quaternion, angular_momentum: Triple, u: Triple) -> Triple:
    a, b, c = body.angular_velocity_at(_cayley(q, u), angular_momentum)
    x, y, z = u
    along = a * x + b * y + c * z
    return (
        0.5 * (a + (b * z - c * y) + along * x),
        0.5 * (b + (c * x - a * z) + along * y),
        0.5 * (c + (a * y - b * x) + along * z),
    )


def _cayley(q: Quaternion, u: Triple) -> Quaternion:
    """(1, u) q, normalised."""
    return normalised(product((1.0, *u), q))


def _quaternion_rate(body: RigidBody, q: Quaternion, angular_momentum: Triple) -> Quaternion:
    a, b, c = body.angular_velocity_at(normalised(q), angular_momentum)
    return product((0.0, a / 2, b / 2, c / 2), q)


def _along(q: Quaternion, rate: Quaternion, h: float) -> Quaternion:
    return (q[0] + h * rate[0], q[1] + h * rate[1], q[2] + h * rate[2], q[3] + h * rate[3])


def _times(v: Triple, factor: float) -> Triple:
    return (v[0] * factor, v[1] * factor, v[2] * factor)
