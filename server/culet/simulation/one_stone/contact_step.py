"""A short step in contact: sliding, rolling, rocking, resting.

In this order (Guendelman, Bridson and Fedkiw 2003): gravity acts on the velocity, the contacts take from it whatever
would carry a vertex into a surface, and only then the stone moves, with the new velocity. A stone at rest gets g h, all
of it is taken back, and it does not move at all: no jitter, no creep. A vertex that is still above its surface may
approach it by its gap in one step and no more.

It moves by the mean of the velocities before and after, if the vertices that press kept to their surface before, too:
sliding is then exact up to the step in which it ends, where the velocity after would fall short by v h / 2. A vertex
that was arriving would get inside, so that the stone then moves by the velocity after.

The step cannot create energy: with v the velocity after it and dv its change, the kinetic part changes by
v . (f h + J p) - |dv|^2 / 2, the potential by -v . f h, and contact impulses do no work on v; with the mean velocity u
it is u . (f h + J p) and -u . f h, and what presses and rubs does no positive work on u. What is left is the
second order of the rotation, and being moved out of a surface by it; both are bounded by slowing the stone down where
there is more energy than before.

Rolling resistance is a moment against the turning, as if the surface gave way and carried the stone a little ahead of
its vertices. Without it a brilliant rocks from one pavilion facet to the next, two degrees away, for half a minute.
"""

from __future__ import annotations

import math

from culet.simulation.one_stone.contact import TOUCH, Contact, closing_speed, contacts_of
from culet.simulation.one_stone.impact import limited
from culet.simulation.one_stone.impulses import solve
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.free_rotation import Integrator, turned
from culet.simulation.rigid_body.motion import (
    BodyMotion,
    centre_gap,
    gaps,
    kinetic_energy,
    pushed_out,
    speed,
    stopped,
    velocities,
)
from culet.simulation.rigid_body.state import Triple

MAX_ROUNDS = 6
"""Of adding vertices that arrive within the step, or of shortening it."""

REST = 1e-6
"""Of the speed that gravity gives in the step: a stone that the contacts leave with less is held by them, and what is
left is the solver's rounding, which would let it creep down a slope by 1e-8 R a second."""

Vertex = tuple[int, int]
"""Surface and vertex."""


def contact_step(
    motion: BodyMotion,
    body: RigidBody,
    touching: list[Contact],
    *,
    gravity: float,
    friction: float,
    rolling_resistance: float,
    bounce_speed: float,
    time: float,
    integrator: Integrator,
) -> tuple[BodyMotion, float]:
    """At most `time` seconds in contact: up to where a vertex arrives faster than `bounce_speed`, R/s.

    The motion then, and the time that it took.
    """
    begun, motion = motion, _resisted(motion, body, rolling_resistance * body.mass * gravity * time)
    vertices = {(point.surface, point.vertex): point.gap for point in touching}
    length = time
    for attempt in range(MAX_ROUNDS):
        points = contacts_of(motion, body, [(*vertex, gap) for vertex, gap in sorted(vertices.items())])
        moving = _kicked_and_stopped(motion, body, points, gravity, friction, length)
        end = _moved(begun, moving, body, points, length, integrator)
        arrived = {vertex: gap for vertex, gap in _inside(end, body).items() if vertex not in vertices}
        if not arrived or attempt == MAX_ROUNDS - 1:
            break
        before = {
            vertex: max(float(gaps(motion, body, body.surfaces[vertex[0]])[vertex[1]]), 0.0) for vertex in arrived
        }
        fast = _fast(moving, body, before, bounce_speed)
        if not fast:
            vertices |= before
            continue
        # straight line between the gaps at both ends; a little early, so that the vertex is outside and touching
        length *= min(max(before[v] - TOUCH / 4, 0.0) / (before[v] - arrived[v]) for v in fast)
        if length <= 1e-9 * time:
            return begun, 0.0
    highest = kinetic_energy(begun, body) + body.mass * gravity * begun.position[1]
    end = pushed_out(end, body)
    if body.mass * gravity * end.position[1] > highest:  # about to stop: the mean went higher than its energy allows
        end = pushed_out(_moved_by(moving, moving, body, length, integrator), body)
    return limited(end, body, highest - body.mass * gravity * end.position[1]), length


def slid(motion: BodyMotion, body: RigidBody, braking: float, time: float) -> BodyMotion:
    """Level, without turning, slower by `braking` R/s^2: what is left of a step too long to follow how it rocks."""
    (px, _, pz), speed_now = motion.momentum, math.hypot(motion.momentum[0], motion.momentum[2]) / body.mass
    part = max(1 - braking * time / speed_now, 0.0) if speed_now > 0 else 0.0
    mean = (1 + part) / 2 * time / body.mass
    x, y, z = motion.position
    moved = motion._replace(position=(x + px * mean, y, z + pz * mean))
    return pushed_out(moved._replace(momentum=(px * part, 0.0, pz * part), angular_momentum=(0.0, 0.0, 0.0)), body)


def _kicked_and_stopped(
    motion: BodyMotion, body: RigidBody, points: list[Contact], gravity: float, friction: float, length: float
) -> BodyMotion:
    px, py, pz = motion.momentum
    kicked = motion._replace(momentum=(px, py - body.mass * gravity * length, pz))
    targets = [-point.gap / length if point.gap > TOUCH else 0.0 for point in points]
    solved = solve(kicked, body, points, targets, friction)
    limit = REST * gravity * length
    held = math.hypot(*solved.momentum) <= limit * body.mass and speed(solved, body) <= limit
    return stopped(solved) if held else solved


def _resisted(motion: BodyMotion, body: RigidBody, moment: float) -> BodyMotion:
    """Rolling resistance: an angular impulse (mass R^2/s) against the turning, too small to turn it round."""
    if moment == 0:
        return motion
    wx, _, wz = body.angular_velocity_at(motion.orientation, motion.angular_momentum)
    turning = math.sqrt(wx * wx + wz * wz)  # about the vertical it would be drilling friction
    if turning == 0:
        return motion
    part = min(moment / turning, body.principal_axes[0].moment / 2)
    lx, ly, lz = motion.angular_momentum
    return motion._replace(angular_momentum=(lx - part * wx, ly, lz - part * wz))


def _moved(
    begun: BodyMotion, moving: BodyMotion, body: RigidBody, points: list[Contact], length: float, integrator: Integrator
) -> BodyMotion:
    """Moved on by the mean of both velocities where that keeps to the surfaces, else by the one at the end."""
    velocity, omega = velocities(begun, body)
    pressed = [point for point in points if any(point.impulse)]
    if any(abs(closing_speed(point, velocity, omega)) * length > TOUCH / 4 for point in pressed):
        return _moved_by(moving, moving, body, length, integrator)
    momentum = _mean(begun.momentum, moving.momentum)
    angular_momentum = _mean(begun.angular_momentum, moving.angular_momentum)
    mean = moving._replace(momentum=momentum, angular_momentum=angular_momentum)
    return _moved_by(mean, moving, body, length, integrator)


def _moved_by(
    mean: BodyMotion, moving: BodyMotion, body: RigidBody, length: float, integrator: Integrator
) -> BodyMotion:
    (x, y, z), (px, py, pz), mass = mean.position, mean.momentum, body.mass
    return moving._replace(
        position=(x + px / mass * length, y + py / mass * length, z + pz / mass * length),
        orientation=turned(body, mean.orientation, mean.angular_momentum, length, integrator),
    )


def _mean(one: Triple, other: Triple) -> Triple:
    (a, b, c), (x, y, z) = one, other
    return ((a + x) / 2, (b + y) / 2, (c + z) / 2)


def _inside(motion: BodyMotion, body: RigidBody) -> dict[Vertex, float]:
    """Vertices deeper than TOUCH inside a surface, with their gaps."""
    found: dict[Vertex, float] = {}
    for number, surface in enumerate(body.surfaces):
        if centre_gap(motion, surface) <= body.hull.radius:
            distances = gaps(motion, body, surface)
            for vertex in (distances < -TOUCH).nonzero()[0].tolist():
                found[number, vertex] = float(distances[vertex])
    return found


def _fast(motion: BodyMotion, body: RigidBody, vertices: dict[Vertex, float], bounce_speed: float) -> list[Vertex]:
    """Those of the vertices that close in faster than `bounce_speed`."""
    velocity, omega = velocities(motion, body)
    points = contacts_of(motion, body, [(*vertex, gap) for vertex, gap in vertices.items()])
    return [(point.surface, point.vertex) for point in points if closing_speed(point, velocity, omega) > bounce_speed]
