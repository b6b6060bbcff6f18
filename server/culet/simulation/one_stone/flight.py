"""Free flight up to the first touch, by conservative advancement: nothing is passed through, at any speed and step.

No point of the stone moves faster than B = |V| + |omega| r, so that nothing can touch for gap / B seconds, nor before
the sphere about the stone does, however it turns. That alone would creep towards a touch, and never get away from one.
So a step may also be as long as the vertices' paths are straight: their acceleration is below A = g + |omega|^2 r, and
between two instants at which a vertex is outside it dips in by no more than A t^2 / 8; `SAGITTA` bounds that. Where a
step ends inside, the touch is found by regula falsi.
"""

from __future__ import annotations

import math

from culet.simulation.one_stone.contact import TOUCH
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.free_rotation import Integrator
from culet.simulation.rigid_body.motion import AT_SURFACE, BodyMotion, centre_gap, flown, gaps
from culet.simulation.rigid_body.state import Triple

SAGITTA = 1e-5
"""R. How deep a vertex may dip in and out unseen. Larger: fewer steps near surfaces, and later touches missed."""
MAX_REFINEMENTS = 80


def fly(
    motion: BodyMotion, body: RigidBody, gravity: float, time: float, integrator: Integrator, shortest: float = 0.0
) -> tuple[BodyMotion, float]:
    """Fly for at most `time` seconds, until a vertex touches; the motion then, and the time that it took.

    The stone must be outside the surfaces (`pushed_out`); it is outside at the end, at a touch by less than TOUCH. A
    flight that no touch ends takes `shortest` seconds or more, whatever dips in and out in them: the centre of mass,
    on its parabola, cannot.
    """
    omega = body.fastest_turn(motion.orientation, motion.angular_momentum)
    turning = omega * body.hull.radius
    part = time
    for surface in body.surfaces:
        approach = _approach(motion, body, surface.normal, gravity, time)
        room = centre_gap(motion, surface) - body.hull.radius
        if room > approach * time:
            continue  # however it turns
        safe = room / approach if room > 0 else 0.0
        room = max(float(gaps(motion, body, surface).min()), 0.0)
        fastest = approach + turning
        if fastest > 0 and room <= fastest * part:  # 0: it leaves, or slides along, without turning
            part = min(part, max(safe, room / fastest))
    if part < time:
        bend = gravity + omega * turning
        straight = math.sqrt(8 * SAGITTA / bend) if bend > 0 else time
        part = min(max(part, straight, shortest), time)
    end = flown(motion, body, gravity, part, integrator)
    inside = _depth(end, body)
    if inside <= AT_SURFACE:
        return end, part
    return _touch(motion, body, gravity, turning, part, inside, integrator)


def _approach(motion: BodyMotion, body: RigidBody, normal: Triple, gravity: float, time: float) -> float:
    """Upper bound of the centre's speed towards a surface within `time`, R/s, at least 0."""
    (px, py, pz), (a, b, c) = motion.momentum, normal
    speed_now = -(px * a + py * b + pz * c) / body.mass
    return max(speed_now + max(gravity * b, 0.0) * time, speed_now, 0.0)


def _depth(motion: BodyMotion, body: RigidBody) -> float:
    """How far the deepest vertex is inside a surface, R; negative: how far the nearest is outside, if near at all."""
    deepest = -math.inf
    for surface in body.surfaces:
        if centre_gap(motion, surface) <= body.hull.radius + TOUCH:
            deepest = max(deepest, -float(gaps(motion, body, surface).min()))
    return deepest


def _touch(
    motion: BodyMotion,
    body: RigidBody,
    gravity: float,
    turning: float,
    late: float,
    inside: float,
    integrator: Integrator,
) -> tuple[BodyMotion, float]:
    """The last instant found before `late`, when a vertex is `inside`, at which all are outside.

    `turning` bounds the speed of any point about the centre, R/s.
    """
    outside, early, at_early = max(-_depth(motion, body), 0.0), 0.0, motion
    for attempt in range(MAX_REFINEMENTS):
        bound = math.hypot(*at_early.momentum) / body.mass + turning + gravity * (late - early)
        if (early > 0 and outside <= TOUCH / 2) or bound * (late - early) <= TOUCH / 2:
            break
        if attempt % 3 == 2 or not math.isfinite(outside):
            middle = (early + late) / 2
        else:  # aimed a little before the crossing, so that the end outside comes near it
            middle = early + (late - early) * max(outside - TOUCH / 4, 0.0) / (outside + inside)
            middle = max(middle, early + 0.01 * (late - early))
        at_middle = flown(motion, body, gravity, middle, integrator)
        depth = _depth(at_middle, body)
        if depth > 0:
            late, inside = middle, depth
        else:
            early, outside, at_early = middle, -depth, at_middle
    return at_early, early
