"""The motion model `rigid`: a rigid polyhedron that falls, bounces, tumbles, slides, and comes to rest on a facet.

A fixed step is spent on three things, in the order in which they come:

    flight         until a vertex touches a surface, exactly on the parabola                      flight.py
    impact         touching vertices arrive faster than the bounce speed: restitution, friction    impact.py
    contact step   they arrive more slowly, or stay: no restitution                                contact_step.py

All small numbers are relative to R and sqrt(R / g), so that the same drop in other units is the same drop. Below the
bounce speed a stone does not bounce: otherwise it would bounce infinitely often in finite time (Zeno).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from culet.scene.model import Simulation as SimulationSettings
from culet.simulation.body import RigidBody
from culet.simulation.contact import TOUCH, closing_speed, contacts
from culet.simulation.contact_step import contact_step
from culet.simulation.flight import fly
from culet.simulation.free_rotation import INTEGRATORS, Integrator
from culet.simulation.impact import impact
from culet.simulation.motion import Motion, gaps, pushed_out, sphere_centre_gap, stopped
from culet.simulation.state import RigidState, Touch, Triple
from culet.simulation.support import is_supported

MAX_EVENTS = 256
"""Flights, impacts and contact steps in one fixed step. What is left of the step then is dropped, and the stone moves
more slowly: that takes spins of thousands of rad/s near a surface, or 1e5 times the gravity."""
MAX_CONTACT_TURN = 0.1
"""rad in one contact step: of second order in it are what lifts a rolling stone and what slows it down."""
SLEEP_SPEED = 1e-6
"""sqrt(g R). On a stable support, a slower stone is at rest: it would move on by less than 1e-6 R."""
SUPPORT_REACH = 10 * TOUCH
"""R. Of the facet that a stone at rest lies on three vertices touch; the others may be a little above the floor."""
ROUNDING = 1e-9
"""Of the speed of the fastest point: vertices that close in more slowly are sliding or turning along the surface."""


class _Scales(NamedTuple):
    """What the settings mean in R and seconds."""

    gravity: float
    bounce_speed: float
    contact_step: float
    sleep_speed: float
    integrator: Integrator


def step(state: RigidState, settings: SimulationSettings, body: RigidBody) -> RigidState:
    """The state one fixed step later."""
    scales = _scales(settings)
    motion = Motion(state.position, state.orientation, state.momentum, state.angular_momentum)
    if _is_inside(motion, body):
        motion = pushed_out(motion, body)
    left, impacts, asleep = settings.time_step, state.impacts, False
    for _ in range(MAX_EVENTS):
        touching = contacts(motion, body)
        if touching:
            velocity = _velocity(motion, body)
            omega = body.angular_velocity_at(motion.orientation, motion.angular_momentum)
            fastest = math.hypot(*velocity) + body.hull.radius * math.hypot(*omega)
            closing = max(closing_speed(point, velocity, omega) for point in touching)
            if closing > max(scales.bounce_speed, ROUNDING * fastest):
                motion = impact(motion, body, touching, settings.restitution, settings.friction)
                impacts += 1
                continue
            slow = settings.sleeping and fastest <= scales.sleep_speed
            if slow and is_supported(contacts(motion, body, SUPPORT_REACH)):
                motion, asleep = stopped(motion), True
                break
            time = min(scales.contact_step, MAX_CONTACT_TURN / math.hypot(*omega) if any(omega) else math.inf)
            time = min(time, left)
            if closing >= -scales.gravity * time:
                motion, taken = contact_step(
                    motion,
                    body,
                    touching,
                    gravity=scales.gravity,
                    friction=settings.friction,
                    rolling_resistance=settings.rolling_resistance,
                    bounce_speed=max(scales.bounce_speed, ROUNDING * fastest),
                    time=time,
                    integrator=scales.integrator,
                )
                left -= taken
                if left <= 0:
                    break
                if taken > 0:
                    continue
        motion, taken = fly(motion, body, scales.gravity, left, scales.integrator)
        left -= taken
        if left <= 0:
            break
    return RigidState(
        step=state.step + 1,
        time=state.time + settings.time_step,
        position=motion.position,
        orientation=motion.orientation,
        momentum=motion.momentum,
        angular_momentum=motion.angular_momentum,
        impacts=impacts,
        asleep=asleep,
    )


def _scales(settings: SimulationSettings) -> _Scales:
    g = settings.gravity
    unit_speed = math.sqrt(g)
    return _Scales(
        gravity=g,
        bounce_speed=settings.bounce_speed * unit_speed,
        contact_step=settings.contact_step / unit_speed if g > 0 else math.inf,
        sleep_speed=SLEEP_SPEED * unit_speed,
        integrator=INTEGRATORS[settings.integrator],
    )


def touch(state: RigidState, body: RigidBody) -> Touch:
    """How the hull's vertices meet the surfaces."""
    motion = Motion(state.position, state.orientation, state.momentum, state.angular_momentum)
    distances = [gaps(motion, body, surface) for surface in body.surfaces]
    deepest = min(float(each.min()) for each in distances)
    touching = sum(int((each <= TOUCH).sum()) for each in distances)
    return Touch(touching, max(-deepest, 0.0), float(distances[0].min()))


def _velocity(motion: Motion, body: RigidBody) -> Triple:
    px, py, pz = motion.momentum
    return (px / body.mass, py / body.mass, pz / body.mass)


def _is_inside(motion: Motion, body: RigidBody) -> bool:
    return any(
        sphere_centre_gap(motion, surface) < body.hull.radius and float(gaps(motion, body, surface).min()) < 0
        for surface in body.surfaces
    )
