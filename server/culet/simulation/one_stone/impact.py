"""Impacts: what happens in no time when vertices arrive at a surface.

Newton's restitution at every touching vertex, v_n+ >= -e v_n-, with Coulomb's friction. Together they can create energy
where slip reverses (Kane 1984; Stronge 1991): then restitution is halved until none is, and at the last taken as 0,
with which no impulse does work.
"""

from __future__ import annotations

from collections.abc import Sequence

from culet.simulation.one_stone.contact import Contact, closing_speed
from culet.simulation.one_stone.impulses import solve
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, kinetic_energy, velocities

ROUNDING = 1e-12
"""Of the kinetic energy: a gain below this is rounding."""
HALVINGS = 4


def impact(
    motion: BodyMotion, body: RigidBody, points: Sequence[Contact], restitution: float, friction: float
) -> BodyMotion:
    """The motion just after: never with more kinetic energy, never with a touching vertex on its way in."""
    velocity, omega = velocities(motion, body)
    closing = [max(closing_speed(point, velocity, omega), 0.0) for point in points]
    before = kinetic_energy(motion, body)
    e = restitution
    for attempt in range(HALVINGS + 1):
        if attempt == HALVINGS:
            e = 0.0
        after = solve(motion, body, points, [e * speed for speed in closing], friction)
        if e == 0 or kinetic_energy(after, body) <= before * (1 + ROUNDING):
            break
        e /= 2
    if kinetic_energy(after, body) > before * (1 + ROUNDING):
        # friction so high that the impulses do not converge (Painlevé): without it the problem is convex
        after = solve(motion, body, points, [0.0] * len(points), 0.0)
    return limited(after, body, before)


def limited(motion: BodyMotion, body: RigidBody, energy: float) -> BodyMotion:
    """The same motion, slower if its kinetic energy is above `energy` (mass R^2/s^2)."""
    kinetic = kinetic_energy(motion, body)
    if kinetic <= max(energy, 0.0):
        return motion
    factor = (max(energy, 0.0) / kinetic) ** 0.5
    (px, py, pz), (lx, ly, lz) = motion.momentum, motion.angular_momentum
    return motion._replace(
        momentum=(px * factor, py * factor, pz * factor), angular_momentum=(lx * factor, ly * factor, lz * factor)
    )
