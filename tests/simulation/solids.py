"""Bodies, states and surfaces for the tests of the simulation."""

from __future__ import annotations

import hashlib
import math
import struct

import numpy as np

from culet.geometry.shape import Shape
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, gaps
from culet.simulation.rigid_body.rotation import IDENTITY, normalised
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, RigidState, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, Surface

G = 9.81
UPRIGHT = IDENTITY
TABLE_DOWN: Quaternion = (0.0, 1.0, 0.0, 0.0)


def rigid(
    stone: Shape,
    position: Triple = (0.0, 4.0, 0.0),
    orientation: Quaternion = UPRIGHT,
    surfaces: tuple[Surface, ...] = (FLOOR,),
    **settings: object,
) -> Simulation:
    """A stone at rest, with nothing but Coulomb's friction; each test says what else there is."""
    bare = {"model": "rigid", "time_step": 1 / 120, "spin": (0, 0, 0), "rolling_resistance": 0}
    return Simulation(SimulationSettings.model_validate(bare | settings), stone, position, orientation, surfaces)


def classic(stone: Shape, position: Triple = (0.0, 4.0, 0.0), **settings: object) -> Simulation:
    """The report's model at its step, otherwise as the scene's default."""
    reported = {"model": "classic", "time_step": 1 / 30}
    return Simulation(SimulationSettings.model_validate(reported | settings), stone, position, UPRIGHT)


def advance(moving: Simulation, seconds: float) -> list[RigidState]:
    """The states of the steps that make up so much time."""
    path = []
    for _ in range(round(seconds / moving.settings.time_step)):
        moving.step()
        path.append(moving.state)
    return path


def apexes(path: list[RigidState]) -> list[float]:
    """Heights of the tops between bounces."""
    heights = [state.position[1] for state in path]
    return [b for a, b, c in zip(heights, heights[1:], heights[2:], strict=False) if a < b >= c]


def numbers(state: RigidState) -> list[float]:
    return [state.time, *state.position, *state.orientation, *state.momentum, *state.angular_momentum]


def digest(path: list[RigidState]) -> str:
    """Of every bit of the states."""
    sha = hashlib.sha256()
    for state in path:
        sha.update(struct.pack("<14d3q", *numbers(state), state.step, state.impacts, state.asleep))
    return sha.hexdigest()


def motion_of(state: RigidState) -> BodyMotion:
    return BodyMotion(state.position, state.orientation, state.momentum, state.angular_momentum)


def nearest(moving: Simulation) -> float:
    """Of all vertices and surfaces, the smallest gap, R."""
    body = moving.body
    return min(float(gaps(motion_of(moving.state), body, surface).min()) for surface in body.surfaces)


def spin_of(moving: Simulation) -> Triple:
    return moving.body.angular_velocity(moving.state)


def about(axis: Triple, angle: float) -> Quaternion:
    """The turn by an angle (radians) about a unit axis."""
    half = angle / 2
    sine = math.sin(half)
    return normalised((math.cos(half), sine * axis[0], sine * axis[1], sine * axis[2]))


TILTED = about((0.6, 0.0, 0.8), 0.7)


def lowest(stone: Shape) -> float:
    """Height at which the unturned stone stands on the floor."""
    return FLOOR.offset - float(stone.vertices[:, 1].min())


def tilted_floor(angle: float) -> Surface:
    """A plane through (0, -1, 0) that falls towards +x at `angle` radians."""
    normal = (math.sin(angle), math.cos(angle), 0.0)
    return Surface(normal, -math.cos(angle))


def random_body(stone: Shape, rng: np.random.Generator) -> tuple[RigidBody, BodyMotion]:
    """The stone with a vertex, edge or facet on the floor, in random motion."""
    body = RigidBody.of(SimulationSettings.model_validate({"model": "rigid", "mass": 1}), stone)
    kind = rng.integers(3)
    if kind == 0:
        q = rng.normal(size=4)
    else:  # turn a facet normal (or a direction between two) down
        down = stone.planes[rng.integers(len(stone.planes)), :3].copy()
        if kind == 2:
            down = down + 1e-3 * rng.normal(size=3)
        q = np.array([1 - down[1], down[2], 0.0, -down[0]]) if down[1] < 1 else np.array([0.0, 1.0, 0.0, 0.0])
    w, x, y, z = q.tolist()
    orientation = normalised((w, x, y, z))
    motion = BodyMotion((0.0, 0.0, 0.0), orientation, tuple(rng.normal(size=3).tolist()), (0.0, 0.0, 0.0))
    omega = tuple((3 * rng.normal(size=3)).tolist())
    depth = float(gaps(motion, body, FLOOR).min())
    return body, motion._replace(
        position=(0.0, -depth, 0.0), angular_momentum=body.angular_momentum(orientation, omega)
    )
