"""Motions of the scene's stone whose ends are known: free flight, a flat landing, a slide, a drop.

flight    free fall. Truth: the parabola, and DOP853.
bounce    a flat landing without friction. Truth: parabolas, each e times as fast as the one before.
slide     Coulomb friction on the floor. Truth: v^2 / (2 mu g).
drop      a tilted, spinning stone, past its first impacts. No closed form: the truth is `rigid` at REFERENCE_STEP,
          and ends where the next impact would make any small difference large.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.scene.room import FLOOR_Y
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.rotation import IDENTITY, rotate
from culet.simulation.rigid_body.settings import SimulationSettings as Settings
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.study.motion.tops import rotation_truth
from culet.study.report import Knob

REFERENCE_STEP: dict[str, Knob] = {"time_step": 1 / 960, "contact_step": 0.001, "integrator": "rkmk4"}


@dataclass(frozen=True)
class KnownMotion:
    """A start, how long it lasts, and which numbers of the settings it fixes."""

    name: str
    seconds: float
    position: Triple
    orientation: Quaternion
    fixed: dict[str, object]


class End(NamedTuple):
    """Where a motion ends; None: unknown."""

    position: NDArray[np.float64] | None
    orientation: Quaternion | None
    energy: float | None
    momentum: NDArray[np.float64] | None
    """Linear, then angular."""
    energy_scale: float
    momentum_scale: tuple[float, float]


def motions_of(shape: Shape) -> Iterator[tuple[KnownMotion, Callable[[str], End]]]:
    """Each motion, and where it ends by the name of the model."""
    flight = KnownMotion("flight", 2.0, (0.0, 100.0, 0.0), IDENTITY, {"spin": (0.5, 3, 1), "velocity": (1, 2, -0.5)})
    yield flight, lambda _: _flight_end(flight, shape)
    lying = flat_orientation(shape)
    half_height = float(-_heights(shape, lying).min())
    bounce = KnownMotion(
        "bounce",
        23 / 15,
        (0.0, FLOOR_Y + 2.5, 0.0),
        lying,
        {"spin": (0, 0, 0), "friction": 0, "restitution": 0.6, "random_torque": 0},
    )
    yield bounce, lambda model: bounce_truth(bounce, 1.0 if model == "classic" else half_height)
    slide = KnownMotion(
        "slide", 1.0, (0.0, FLOOR_Y + half_height, 0.0), lying,
        {"spin": (0, 0, 0), "velocity": (1, 0, 0), "friction": 0.3, "rolling_resistance": 0, "sleeping": False},
    )  # fmt: skip
    yield slide, lambda _: _slide_end(slide)
    drop = KnownMotion(
        "drop", 1.0, (0.0, 0.5, 0.0), (0.93670, 0.33047, 0.0, 0.11566), {"spin": (0.5, 3, 0), "random_torque": 0}
    )
    yield drop, lambda _: _drop_end(drop, shape)


def flat_orientation(shape: Shape) -> Quaternion:
    """The stone turned so that the facet with the largest area is its lowest."""
    areas = np.zeros(len(shape.planes))
    corners = shape.vertices[shape.triangles]
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    np.add.at(areas, shape.facet_of_triangle, doubled)
    x, y, z = shape.planes[int(areas.argmax()), :3].tolist()
    if y > 1 - 1e-12:
        return (0.0, 1.0, 0.0, 0.0)
    # the half-way quaternion from the normal n to -e_y is (1 - n.y, n x -e_y), normalised
    q = np.array([1 - y, z, 0.0, -x])
    w, a, b, c = (q / np.linalg.norm(q)).tolist()
    return w, a, b, c


def _heights(shape: Shape, orientation: Quaternion) -> NDArray[np.float64]:
    return np.array([rotate(orientation, tuple(vertex))[1] for vertex in shape.vertices.tolist()])


def settings_of(motion: KnownMotion, knobs: dict[str, Knob]) -> Settings:
    """The motion's own settings, with the knobs turned."""
    return Settings.model_validate({**motion.fixed, **{k: v for k, v in knobs.items() if v is not None}})


def started(motion: KnownMotion, shape: Shape, knobs: dict[str, Knob]) -> Simulation:
    """The stone at the motion's start."""
    return Simulation(settings_of(motion, knobs), shape, motion.position, motion.orientation)


def _flight_end(motion: KnownMotion, shape: Shape) -> End:
    simulation = started(motion, shape, {"model": "rigid"})
    body, state, g = simulation.body, simulation.state, simulation.settings.gravity
    t = motion.seconds
    velocity = np.array(body.velocity(state))
    fall = np.array([0.0, g, 0.0])
    momentum = body.mass * (velocity - fall * t)
    return End(
        position=np.array(state.position) + velocity * t - fall * t * t / 2,
        orientation=rotation_truth(body, state.orientation, state.angular_momentum, t),
        energy=simulation.energy(),
        momentum=np.array([*momentum, *state.angular_momentum]),
        energy_scale=body.energy(state, 0),  # the kinetic part: the height's zero is arbitrary
        momentum_scale=(float(np.linalg.norm(momentum)), float(np.linalg.norm(state.angular_momentum))),
    )


def bounce_truth(motion: KnownMotion, radius: float) -> End:
    """Where a body of that radius is that lands flat and without friction, each bounce e times as fast as the last."""
    settings = settings_of(motion, {})
    g, e, mass = settings.gravity, settings.restitution, settings.mass
    clearance = motion.position[1] - FLOOR_Y - radius
    t, speed = motion.seconds - math.sqrt(2 * clearance / g), e * math.sqrt(2 * g * clearance)
    if t >= 2 * speed / g / (1 - e):  # infinitely many bounces are over
        t = speed = 0.0
    while t > 2 * speed / g:
        t, speed = t - 2 * speed / g, e * speed
    height, velocity = speed * t - g * t * t / 2, speed - g * t
    y = FLOOR_Y + radius + height
    energy = mass * (velocity**2 / 2 + g * (y - FLOOR_Y - 1))
    start = mass * g * clearance
    return End(
        position=np.array([0.0, y, 0.0]),
        orientation=motion.orientation,
        energy=energy,
        momentum=np.array([0, mass * velocity, 0, 0, 0, 0]),
        energy_scale=start,
        momentum_scale=(mass * math.sqrt(2 * g * clearance), mass),
    )


def _slide_end(motion: KnownMotion) -> End:
    settings = settings_of(motion, {})
    speed, decay = settings.velocity[0], settings.friction * settings.gravity
    x, y, z = motion.position
    stopped = np.array([x + speed**2 / (2 * decay), y, z])
    scale = settings.mass * speed
    return End(
        position=stopped,
        orientation=motion.orientation,
        energy=settings.mass * settings.gravity * (y - FLOOR_Y - 1),
        momentum=np.zeros(6),
        energy_scale=settings.mass * speed**2 / 2,
        momentum_scale=(scale, scale),
    )


def _drop_end(motion: KnownMotion, shape: Shape) -> End:
    simulation = started(motion, shape, {"model": "rigid", **REFERENCE_STEP})
    start = simulation.energy()
    while simulation.state.time < motion.seconds - 1e-9:
        simulation.step()
    state = simulation.state
    linear = simulation.body.mass * math.sqrt(2 * simulation.settings.gravity * motion.position[1] + 1)
    return End(
        position=np.array(state.position),
        orientation=state.orientation,
        energy=start,
        momentum=np.array([*state.momentum, *state.angular_momentum]),
        energy_scale=simulation.body.mass * simulation.settings.gravity,
        momentum_scale=(linear, linear),
    )
