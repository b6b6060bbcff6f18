"""Stones and worlds of the trials, and what is measured of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.shape import Shape
from culet.scene.motion import MotionLaws
from culet.simulation.bodies import Body, BodyState
from culet.simulation.rigid_body.rotation import IDENTITY, normalised, rotate
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, Surface
from culet.simulation.together import SolverEffort, angular_momentum_by
from culet.simulation.world import World

Floats = NDArray[np.float64]
G = 9.81
STEP = 1 / 120
BOWL = (
    FLOOR,
    *(Surface((0.6 * math.cos(a), 0.8, 0.6 * math.sin(a)), -1.2) for a in (0, 2 * math.pi / 3, 4 * math.pi / 3)),
)
"""Three slanted walls about the origin: what falls there comes to lie in a heap."""


def law(**settings: object) -> MotionLaws:
    """Of the scene's default, without rolling resistance; each trial says what else."""
    return MotionLaws.model_validate({"rolling_resistance": 0, "time_step": STEP} | settings)


def beside_another(
    body: Body, given: MotionLaws, surfaces: Sequence[Surface] = (FLOOR,), effort: SolverEffort | None = None
) -> World:
    """The stone, and one far away that is held: the solver of several stones moves it, and nothing disturbs it."""
    moving = World([body, Body("far", body.shape, (500.0, 500.0, 0.0), IDENTITY)], surfaces, given, effort)
    moving.hold("far", held=True)
    return moving


def advance(moving: World, seconds: float) -> None:
    """By whole steps."""
    for _ in range(round(seconds / moving.law.time_step)):
        moving.step()


def turned(rng: np.random.Generator) -> Quaternion:
    """Any orientation, each as likely."""
    w, x, y, z = rng.normal(size=4).tolist()
    return normalised((w, x, y, z))


def triple(numbers: Floats) -> Triple:
    """Plain floats."""
    x, y, z = numbers.tolist()
    return (x, y, z)


def level(shape: Shape, facet: int) -> Quaternion:
    """The orientation in which that facet is below and level."""
    return turning(triple(shape.planes[facet, :3]), (0.0, -1.0, 0.0))


def turning(one: Triple, other: Triple) -> Quaternion:
    """The shortest turn of one unit vector to another."""
    cosine = sum(a * b for a, b in zip(one, other, strict=True))
    if cosine < -1 + 1e-12:
        across = np.cross(one, (1.0, 0.0, 0.0) if abs(one[0]) < 0.9 else (0.0, 1.0, 0.0))
        return normalised((0.0, *triple(across)))
    return normalised((1 + cosine, *triple(np.cross(one, other))))


def about(axis: Triple, angle: float) -> Quaternion:
    """The turn by an angle (radians) about an axis."""
    sine = math.sin(angle / 2) / math.hypot(*axis)
    return normalised((math.cos(angle / 2), sine * axis[0], sine * axis[1], sine * axis[2]))


def angle_between(one: Quaternion, other: Quaternion) -> float:
    """Of the turn from one orientation to another, radians."""
    w, x, y, z = one
    difference = np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]]) @ other
    return 2 * math.asin(min(1.0, float(np.linalg.norm(difference))))


def standing(name: str, shape: Shape, orientation: Quaternion, gap: float = 0.0) -> Body:
    """Above the origin, its lowest corner so far above the floor."""
    lowest = min(rotate(orientation, (x, y, z))[1] for x, y, z in shape.vertices.tolist())
    return Body(name, shape, (0.0, FLOOR.offset - lowest + gap, 0.0), orientation)


def solid(name: str, points: Sequence[tuple[float, float, float]]) -> Shape:
    """The convex hull of points about the origin."""
    planes = ConvexHull(np.array(points)).equations
    unique = np.unique(np.round(planes, 9), axis=0)
    return shape_from_half_spaces(name, np.column_stack([unique[:, :3], -unique[:, 3]]))


def step_cut() -> Shape:
    """Low and broad, eight sides in tiers: it can be stacked."""
    tiers = ((0.35, 0.55), (0.2, 0.8), (0.08, 1.0), (0.0, 1.0), (-0.25, 0.75), (-0.4, 0.5))
    angles = [2 * math.pi * (k + 0.5) / 8 for k in range(8)]
    return solid("step cut", [(r * math.cos(a), y, 0.7 * r * math.sin(a)) for y, r in tiers for a in angles])


def stable_facets(shape: Shape) -> list[int]:
    """On which it can lie: the centre of mass is above the facet by 1e-4 R and more."""
    found = []
    for facet, (x, y, z, offset) in enumerate(shape.planes.tolist()):
        normal, foot = np.array((x, y, z)), offset * np.array((x, y, z))
        own = shape.vertices[abs(shape.vertices @ normal - offset) < 1e-6]
        around = np.cross(normal, own[np.argmax(np.linalg.norm(own - foot, axis=1))] - foot)
        axes = np.column_stack([np.cross(around, normal), around])
        axes /= np.linalg.norm(axes, axis=0)
        sides = ConvexHull((own - foot) @ axes).equations
        if (sides[:, 2] < -1e-4).all():
            found.append(facet)
    return found


def facet_below(body: Body, state: BodyState) -> tuple[int, float]:
    """The facet that is lowest, and by how many degrees it is not level."""
    downward = [-rotate(state.orientation, (x, y, z))[1] for x, y, z, _ in body.shape.planes.tolist()]
    facet = int(np.argmax(downward))
    return facet, math.degrees(math.acos(min(1.0, downward[facet])))


def corners(body: Body, state: BodyState) -> Floats:
    """(V, 3) in the world."""
    axes = np.array([rotate(state.orientation, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))])
    found: Floats = body.shape.vertices * body.scale @ axes + state.position
    return found


def overlap(moving: World) -> float:
    """How deep any stone is in a surface or in another, R; negative: all are apart."""
    deepest = -math.inf
    bodies = list(zip(moving.bodies, moving.state.bodies, strict=True))
    for number, (body, state) in enumerate(bodies):
        for normal, offset in moving.surfaces:
            deepest = max(deepest, offset - float((corners(body, state) @ normal).min()))
        for other, there in bodies[:number]:
            if math.dist(state.position, there.position) < body.scale + other.scale:
                deepest = max(deepest, -moving.separation(body.name, other.name))
    return deepest


def momenta(moving: World) -> tuple[Floats, Floats]:
    """Linear, and angular about the origin, of all stones together."""
    linear, angular = np.zeros(3), np.zeros(3)
    for body, state in zip(moving.bodies, moving.state.bodies, strict=True):
        momentum = body.mass * np.array(state.velocity)
        linear += momentum
        angular += np.cross(state.position, momentum) + angular_momentum_by(body, moving.law, state)
    return linear, angular


@dataclass(frozen=True)
class Course:
    """What has come of a world while it ran."""

    finite: bool
    rise: float
    """Of the energy above the lowest before, mass R^2/s^2."""
    deepest: float
    """Overlap at any time, R."""
    final: float
    """Overlap at the end, R."""
    fallen: int
    """Stones that are below the floor at the end."""
    asleep_after: float
    """s; infinite: not all sleep."""
    energy: float
    """At the start."""
    positions: tuple[Triple, ...]
    """At the end."""


def watch(moving: World, seconds: float, every: int = 3) -> Course:
    """Let it run, and look at the overlaps every few steps."""
    start = lowest = moving.energy()
    rise, deepest, finite, asleep = 0.0, -math.inf, True, math.inf
    for step in range(round(seconds / moving.law.time_step)):
        moving.step()
        energy = moving.energy()
        finite = finite and math.isfinite(energy)
        rise, lowest = max(rise, energy - lowest), min(lowest, energy)
        if step % every == 0:
            deepest = max(deepest, overlap(moving))
        if moving.settled:
            asleep = moving.state.time
            break
    below = sum(state.position[1] < FLOOR.offset - 0.5 for state in moving.state.bodies)
    final, positions = overlap(moving), tuple(state.position for state in moving.state.bodies)
    return Course(finite, rise, max(deepest, final), final, below, asleep, start, positions)
