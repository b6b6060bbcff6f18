"""Stones, worlds and measures for the tests of several stones."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.scene.model import Simulation as Law
from culet.simulation.bodies import Body, BodyState
from culet.simulation.rotation import IDENTITY, normalised, rotate
from culet.simulation.state import Quaternion, Triple
from culet.simulation.surfaces import FLOOR, Surface
from culet.simulation.together import Effort, angular_momentum_by
from culet.simulation.world import World

Floats = NDArray[np.float64]
G = 9.81
BOWL = (FLOOR, *(Surface((math.cos(a) * 0.6, 0.8, math.sin(a) * 0.6), -1.2) for a in (0, 2.0943951, 4.1887902)))
"""Three slanted walls that meet about the origin."""


def law(**settings: object) -> Law:
    """Only Coulomb's friction; each test says what else there is."""
    return Law.model_validate({"rolling_resistance": 0, "time_step": 1 / 120} | settings)


def world(
    bodies: Sequence[Body], surfaces: Sequence[Surface] = (FLOOR,), effort: Effort | None = None, **settings: object
) -> World:
    return World(bodies, surfaces, law(**settings), effort)


def with_another(
    body: Body, surfaces: Sequence[Surface] = (FLOOR,), effort: Effort | None = None, **settings: object
) -> World:
    """The stone, and one far away that does not move: so that the solver of several moves it."""
    other = Body("far", body.shape, (500.0, 500.0, 0.0), IDENTITY)
    moving = world([body, other], surfaces, effort, **settings)
    moving.hold("far", held=True)
    return moving


def random_orientation(rng: np.random.Generator) -> Quaternion:
    w, x, y, z = rng.normal(size=4).tolist()
    return normalised((w, x, y, z))


def random_vector(rng: np.random.Generator, size: float) -> Triple:
    x, y, z = (size * rng.normal(size=3)).tolist()
    return (x, y, z)


def corners(body: Body, state: BodyState) -> Floats:
    """(V, 3) in the world."""
    axes = np.array([rotate(state.orientation, axis) for axis in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))])
    found: Floats = body.shape.vertices * body.scale @ axes + state.position
    return found


def facing_down(stone: Shape, facet: int) -> Quaternion:
    """The orientation in which a facet is level and below."""
    x, y, z = stone.planes[facet, :3].tolist()
    return normalised((1 - y, z, 0.0, -x)) if y < 1 else (0.0, 1.0, 0.0, 0.0)


def standing(name: str, stone: Shape, orientation: Quaternion, gap: float = 0.0, **more: object) -> Body:
    """Above the origin, its lowest corner so far above the floor."""
    lowest = min(rotate(orientation, (x, y, z))[1] for x, y, z in stone.vertices.tolist())
    given: dict[str, object] = {"position": (0.0, FLOOR.offset - lowest + gap, 0.0), "orientation": orientation} | more
    return Body(name, stone, **given)  # type: ignore[arg-type]


def deepest(moving: World) -> float:
    """How far any two stones, or a stone and a surface, overlap, R; negative: all are apart."""
    found = -math.inf
    for body, state in zip(moving.bodies, moving.state.bodies, strict=True):
        points = corners(body, state)
        for surface in moving.surfaces:
            found = max(found, surface.offset - float((points @ surface.normal).min()))
    for number, (body, state) in enumerate(zip(moving.bodies, moving.state.bodies, strict=True)):
        for other, there in zip(moving.bodies[:number], moving.state.bodies[:number], strict=True):
            if math.dist(state.position, there.position) < body.scale + other.scale:
                found = max(found, -moving.separation(body.name, other.name))
    return found


def momenta(
    moving: World,
) -> tuple[Floats, Floats]:
    """Of all stones together, the angular one about the origin."""
    linear, angular = np.zeros(3), np.zeros(3)
    for body, state in zip(moving.bodies, moving.state.bodies, strict=True):
        momentum = body.mass * np.array(state.velocity)
        linear += momentum
        angular += np.cross(state.position, momentum) + angular_momentum_by(body, moving.law, state)
    return linear, angular


def advance(moving: World, seconds: float) -> None:
    for _ in range(round(seconds / moving.law.time_step)):
        moving.step()


def scattered(count: int, stone: Shape, seed: int) -> list[Body]:
    """In layers of four above the bowl, turned and spinning at random."""
    rng, bodies = np.random.default_rng(seed), []
    for i in range(count):
        layer, place = divmod(i, 4)
        angle, way = place * math.pi / 2 + layer * 0.5, 1.15 * math.sqrt(2) * 1.05
        x, z = way * math.cos(angle) + rng.uniform(-0.05, 0.05), way * math.sin(angle) + rng.uniform(-0.05, 0.05)
        velocity, spin = random_vector(rng, 0.2), random_vector(rng, 2.0)
        at = (x, 2.3 + 2.3 * layer, z)
        bodies.append(Body(f"stone-{i}", stone, at, random_orientation(rng), velocity, spin))
    return bodies
