"""Where a body is and how it moves, within a step."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.free_rotation import Integrator, turned
from culet.simulation.rigid_body.rotation import rotate_back
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.rigid_body.surfaces import Surface

AT_SURFACE = 1e-12
"""R. A vertex that is no deeper inside a surface is at it: several surfaces cannot all be left by less."""


class BodyMotion(NamedTuple):
    """As in RigidState, without what only whole steps have."""

    position: Triple
    orientation: Quaternion
    momentum: Triple
    angular_momentum: Triple


def flown(motion: BodyMotion, body: RigidBody, gravity: float, time: float, integrator: Integrator) -> BodyMotion:
    """Free flight: the centre of mass on its parabola, exactly; the rotation by the integrator."""
    (x, y, z), (px, py, pz), mass = motion.position, motion.momentum, body.mass
    position = (x + px / mass * time, y + py / mass * time - 0.5 * gravity * time * time, z + pz / mass * time)
    orientation = turned(body, motion.orientation, motion.angular_momentum, time, integrator)
    return BodyMotion(position, orientation, (px, py - mass * gravity * time, pz), motion.angular_momentum)


def gaps(motion: BodyMotion, body: RigidBody, surface: Surface) -> NDArray[np.float64]:
    """(V,) distances of the hull's vertices from a surface, R; negative behind it."""
    return body.hull.heights(rotate_back(motion.orientation, surface.normal)) + centre_gap(motion, surface)


def centre_gap(motion: BodyMotion, surface: Surface) -> float:
    """Distance of the centre of mass from a surface, R."""
    (a, b, c), (x, y, z) = surface.normal, motion.position
    return a * x + b * y + c * z - surface.offset


def velocities(motion: BodyMotion, body: RigidBody) -> tuple[Triple, Triple]:
    """Of the centre of mass, R/s, and of the rotation, rad/s; world axes."""
    px, py, pz = motion.momentum
    velocity = (px / body.mass, py / body.mass, pz / body.mass)
    return velocity, body.angular_velocity_at(motion.orientation, motion.angular_momentum)


def kinetic_energy(motion: BodyMotion, body: RigidBody) -> float:
    """mass R^2/s^2."""
    (px, py, pz), (lx, ly, lz) = motion.momentum, motion.angular_momentum
    wx, wy, wz = body.angular_velocity_at(motion.orientation, motion.angular_momentum)
    return (px * px + py * py + pz * pz) / (2 * body.mass) + 0.5 * (lx * wx + ly * wy + lz * wz)


def speed(motion: BodyMotion, body: RigidBody) -> float:
    """Upper bound of how fast any point of the stone moves, R/s."""
    px, py, pz = motion.momentum
    return math.sqrt(px * px + py * py + pz * pz) / body.mass + body.hull.radius * body.fastest_turn(
        motion.orientation, motion.angular_momentum
    )


def stopped(motion: BodyMotion) -> BodyMotion:
    """At rest in the same place."""
    return motion._replace(momentum=(0.0, 0.0, 0.0), angular_momentum=(0.0, 0.0, 0.0))


def pushed_out(motion: BodyMotion, body: RigidBody) -> BodyMotion:
    """Moved straight out of whatever surface it reaches into; its velocity knows nothing of it.

    Several surfaces are served one after the other, again and again: a corner takes a few rounds, as each moves the
    stone along the others.
    """
    for _ in range(100):
        deepest = 0.0
        for surface in body.surfaces:
            if centre_gap(motion, surface) > body.hull.radius:
                continue
            depth = -float(gaps(motion, body, surface).min())
            if depth > 0:
                (x, y, z), (a, b, c) = motion.position, surface.normal
                motion = motion._replace(position=(x + a * depth, y + b * depth, z + c * depth))
                deepest = max(deepest, depth)
        if deepest < AT_SURFACE:
            break
    return motion
