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

from culet.simulation.one_stone.contact import TOUCH, Contact, closing_speed, contacts
from culet.simulation.one_stone.contact_step import contact_step, slid
from culet.simulation.one_stone.flight import fly
from culet.simulation.one_stone.impact import impact
from culet.simulation.one_stone.support import is_supported
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.free_rotation import INTEGRATORS, Integrator
from culet.simulation.rigid_body.motion import (
    BodyMotion,
    centre_gap,
    gaps,
    kinetic_energy,
    pushed_out,
    stopped,
    velocities,
)
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import RigidState, Touch

EXACT_EVENTS = 256
"""Flights, impacts and contact steps in one fixed step. From then on each takes at least its share of what is left, so
that no time is lost, and the step counts as coarse: vertices dip in and out unseen, contact steps are long. That takes
spins of hundreds of rad/s near a surface, or 1e4 times the gravity."""
MAX_EVENTS = 384
"""What is left after so many is one contact step: every fixed step takes its time."""
SETTLING_EVENTS = 32
"""The last of them, without restitution: nothing cuts a contact step short."""
MAX_CONTACT_TURN = 0.1
"""rad in one contact step: of second order in it are what lifts a rolling stone and what slows it down."""
SLEEP_SPEED = 1e-6
"""sqrt(g R). On a stable support, a slower stone is at rest: it would move on by less than 1e-6 R."""
SUPPORT_REACH = 10 * TOUCH
"""R. Of the facet that a stone at rest lies on three vertices touch; the others may be a little above the floor."""
ROUNDING = 1e-9
"""Of the speed of the fastest point: vertices that close in more slowly are sliding or turning along the surface."""


class _Law(NamedTuple):
    """What the settings mean, in R and seconds."""

    gravity: float
    restitution: float
    friction: float
    rolling_resistance: float
    bounce_speed: float
    contact_step: float
    sleep_speed: float
    """Below 0: the stone may not sleep."""
    integrator: Integrator


class _Course(NamedTuple):
    """How far a fixed step has come."""

    motion: BodyMotion
    left: float
    """s."""
    shortest: float = 0.0
    """s. The next event takes no less, unless the step ends or a vertex touches; 0: it is followed exactly."""
    settling: bool = False
    """Whether vertices that arrive stay."""
    impacts: int = 0
    asleep: bool = False


def step(state: RigidState, settings: SimulationSettings, body: RigidBody) -> RigidState:
    """The state one fixed step later."""
    law = _law(settings)
    motion = BodyMotion(state.position, state.orientation, state.momentum, state.angular_momentum)
    if _is_inside(motion, body):
        motion = pushed_out(motion, body)
    course = _Course(motion, settings.time_step)
    for event in range(MAX_EVENTS):
        if event >= EXACT_EVENTS:
            share = course.left / (MAX_EVENTS - event)
            course = course._replace(shortest=share, settling=event >= MAX_EVENTS - SETTLING_EVENTS)
        course = _next(course, law, body)
        if course.left <= 0 or course.asleep:
            break
    else:
        course = _in_contact(course, law, body, contacts(course.motion, body), math.inf, course.left)
    motion = course.motion
    return RigidState(
        step=state.step + 1,
        time=state.time + settings.time_step,
        position=motion.position,
        orientation=motion.orientation,
        momentum=motion.momentum,
        angular_momentum=motion.angular_momentum,
        impacts=state.impacts + course.impacts,
        asleep=course.asleep,
        coarse=state.coarse + (course.shortest > 0),
    )


def _next(course: _Course, law: _Law, body: RigidBody) -> _Course:
    """After the next flight, impact or contact step."""
    motion = course.motion
    touching = contacts(motion, body)
    if touching:
        velocity, omega = velocities(motion, body)
        turning = math.hypot(*omega)
        fastest = math.hypot(*velocity) + body.hull.radius * turning
        bounce_speed = math.inf if course.settling else max(law.bounce_speed, ROUNDING * fastest)
        closing = max(closing_speed(point, velocity, omega) for point in touching)
        if closing > bounce_speed:
            after = impact(motion, body, touching, law.restitution, law.friction)
            return course._replace(motion=after, impacts=course.impacts + 1)
        if fastest <= law.sleep_speed and is_supported(contacts(motion, body, SUPPORT_REACH)):
            return course._replace(motion=stopped(motion), asleep=True)
        time = max(min(law.contact_step, MAX_CONTACT_TURN / turning if turning > 0 else math.inf), course.shortest)
        time = course.left / max(math.ceil(course.left / time), 1)  # in equal parts
        if closing >= -law.gravity * time:
            further = _in_contact(course, law, body, touching, bounce_speed, time)
            if further.left < course.left:
                return further
    after, taken = fly(motion, body, law.gravity, course.left, law.integrator, course.shortest)
    return course._replace(motion=after, left=course.left - taken)


def _in_contact(
    course: _Course, law: _Law, body: RigidBody, touching: list[Contact], bounce_speed: float, time: float
) -> _Course:
    """After a contact step; if a coarse one would have to be lifted out by more than it can rise, it only slides."""
    motion = course.motion
    after, taken = contact_step(
        motion,
        body,
        touching,
        gravity=law.gravity,
        friction=law.friction,
        rolling_resistance=law.rolling_resistance,
        bounce_speed=bounce_speed,
        time=time,
        integrator=law.integrator,
    )
    if after == motion and taken > 0:  # at rest, and held: nor will any further step move it
        return course._replace(left=0.0)
    weight = body.mass * law.gravity
    highest = kinetic_energy(motion, body) + weight * motion.position[1]
    if course.shortest > 0 and weight * after.position[1] > highest:
        after = slid(motion, body, law.friction * law.gravity, taken)
        if weight * after.position[1] > highest:
            after = stopped(motion)
    return course._replace(motion=after, left=course.left - taken)


def _law(settings: SimulationSettings) -> _Law:
    g = settings.gravity
    unit_speed = math.sqrt(g)
    return _Law(
        gravity=g,
        restitution=settings.restitution,
        friction=settings.friction,
        rolling_resistance=settings.rolling_resistance,
        bounce_speed=settings.bounce_speed * unit_speed,
        contact_step=settings.contact_step / unit_speed if g > 0 else math.inf,
        sleep_speed=SLEEP_SPEED * unit_speed if settings.sleeping else -1.0,
        integrator=INTEGRATORS[settings.integrator],
    )


def touch(state: RigidState, body: RigidBody) -> Touch:
    """How the hull's vertices meet the surfaces."""
    motion = BodyMotion(state.position, state.orientation, state.momentum, state.angular_momentum)
    distances = [gaps(motion, body, surface) for surface in body.surfaces]
    deepest = min(float(each.min()) for each in distances)
    touching = sum(int((each <= TOUCH).sum()) for each in distances)
    return Touch(touching, max(-deepest, 0.0), float(distances[0].min()))


def _is_inside(motion: BodyMotion, body: RigidBody) -> bool:
    return any(
        centre_gap(motion, surface) < body.hull.radius and float(gaps(motion, body, surface).min()) < 0
        for surface in body.surfaces
    )
