"""One stone, moved by the solver of several: flight, bounces, sliding, rest, where it comes to lie."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from culet.simulation.bodies import Body, BodyState
from culet.simulation.rigid_body.rotation import product, rotate_back
from culet.simulation.rigid_body.surfaces import FLOOR
from culet.simulation.together import SolverEffort, angular_momentum_by
from culet.simulation.world import World
from culet.study.contacts.finding import Finding
from culet.study.contacts.worlds import (
    G,
    about,
    advance,
    angle_between,
    beside_another,
    corners,
    facet_below,
    law,
    level,
    stable_facets,
    standing,
    triple,
    turned,
    turning,
)  # fmt: skip
from culet.study.solids import box, brilliant

TABLE = (0.0, 1.0, 0.0)
"""The normal of a brilliant's table."""
LENGTH = (1.0, 0.0, 0.0)
"""Of a needle."""


needle = box(1, 1e-2, 1e-2)


def table_facet() -> int:
    """Of the brilliant."""
    return int(np.argmax(brilliant().planes[:, 1]))


def flight() -> Iterator[Finding]:
    """A brilliant and a needle: symmetric tops, which turn about L at |L| / I and about their own axis at the rest."""
    for name, shape, axis in (("flight", brilliant(), TABLE), ("flight of a needle 100 : 1", needle(), LENGTH)):
        spin, orientation, time = (5.0, 20.0, 3.0), about((1.0, 0.0, 0.3), 0.7), 2.0
        body = Body("one", shape, (0.0, 60.0, 0.0), orientation, (1.0, 0.0, 0.5), spin)
        moving = beside_another(body, law())
        momentum = np.array(angular_momentum_by(body, moving.law, moving.state.bodies[0]))
        inertia = np.array(body.shape.mass.inertia) * body.mass
        along = float(np.array(axis) @ inertia @ axis)
        across = (float(np.trace(inertia)) - along) / 2
        own = sum(a * b for a, b in zip(rotate_back(orientation, spin), axis, strict=True)) * (1 - along / across)
        expected = product(
            about(triple(momentum), float(np.linalg.norm(momentum)) / across * time),
            product(orientation, about(axis, own * time)),
        )
        advance(moving, time)
        state = moving.state.bodies[0]
        after = np.array(angular_momentum_by(body, moving.law, state))
        place = (time, 60 - G * time**2 / 2, 0.5 * time)
        yield Finding(f"{name}, 2 s at 20 rad/s, orientation", angle_between(expected, state.orientation), 1e-6, "rad")
        change = float(np.linalg.norm(after - momentum) / np.linalg.norm(momentum))
        yield Finding(f"{name}, angular momentum, relative", change, 1e-12)
        yield Finding(f"{name}, place on the parabola", math.dist(place, state.position), 1e-10, "R")


def bounces() -> Iterator[Finding]:
    """Flat on the table from 2 R: apexes at e^2n of the height, without turning."""
    body = standing("one", brilliant(), level(brilliant(), table_facet()), gap=2.0)
    moving, ground = beside_another(body, law()), body.position[1] - 2
    apexes: list[float] = []
    rising = False
    while len(apexes) < 3:
        moving.step()
        state = moving.state.bodies[0]
        upward = state.velocity[1]
        if rising and upward <= 0:  # the top was within the step
            apexes.append((state.position[1] - ground + upward**2 / 2 / G) / 2)
        rising = upward > 0
    error = max(abs(apex / 0.36 ** (n + 1) - 1) for n, apex in enumerate(apexes))
    yield Finding("three bounces, heights", error, 1e-3)
    yield Finding("three bounces, spin", math.hypot(*moving.state.bodies[0].spin), 1e-3, "rad/s")


def sliding() -> Iterator[Finding]:
    """v^2 / (2 mu g), in every direction."""
    worst = 0.0
    for angle in (0.0, 0.4, 0.9):
        flat = standing("one", brilliant(), level(brilliant(), table_facet()))
        body = Body("one", flat.shape, flat.position, flat.orientation, (3 * math.cos(angle), 0.0, 3 * math.sin(angle)))
        moving = beside_another(body, law(restitution=0))
        advance(moving, 3)
        x, _, z = moving.state.bodies[0].position
        worst = max(worst, abs(math.hypot(x, z) / (9 / 2 / 0.3 / G) - 1))
    yield Finding("sliding distance", worst, 3e-3)


def rest(seconds: float = 60.0) -> Iterator[Finding]:
    """Without sleep, on the table and on a pavilion facet."""
    shape, drift, depth = brilliant(), 0.0, 0.0
    pavilion = next(facet for facet in stable_facets(shape) if shape.planes[facet, 1] < 0)
    for facet in (table_facet(), pavilion):
        body = standing("one", shape, level(shape, facet), gap=1e-3)
        moving = beside_another(body, law(sleeping=False))
        advance(moving, 3)
        before = moving.state.bodies[0].position
        advance(moving, seconds)
        state = moving.state.bodies[0]
        drift = max(drift, math.dist(before, state.position))
        depth = max(depth, FLOOR.offset - float(corners(body, state)[:, 1].min()))
    yield Finding(f"{seconds:g} s at rest without sleep, drift", drift, 1e-9, "R")
    yield Finding(f"{seconds:g} s at rest without sleep, depth", depth, 1e-5, "R")


def drops(count: int = 300) -> Iterator[Finding]:
    """From 2.5 R, turned and spinning at random, with rolling resistance: each sleeps on a facet that can carry it."""
    rng, shape = np.random.default_rng(5), brilliant()
    stable, on_table, astray, tilt = set(stable_facets(shape)), 0, 0, 0.0
    for _ in range(count):
        body = Body("one", shape, (0.0, 1.5, 0.0), turned(rng), spin=triple(2 * rng.normal(size=3)))
        moving = beside_another(body, law(rolling_resistance=0.02))
        while not moving.settled and moving.state.time < 40:
            moving.step()
        facet, away = facet_below(body, moving.state.bodies[0])
        tilt = max(tilt, away)
        on_table += facet == table_facet()
        astray += facet not in stable or not moving.settled
    yield Finding(f"{count} drops, not asleep on a stable facet", astray, 0)
    yield Finding(f"{count} drops, largest tilt", tilt, 0.01, "degrees")
    if count >= 100:
        yield Finding(f"{count} drops, on the table", on_table / count, 0.55, least=0.35)


def balancing() -> Iterator[Finding]:
    """On the culet, on an edge between two pavilion facets: by 1e-3 rad beside the balance, and at it."""
    asleep = 0
    for body in balanced():
        for rolling in (0.0, 0.02):
            moving = beside_another(body, law(restitution=0, rolling_resistance=rolling))
            for _ in range(20 * 120):
                moving.step()
                if moving.state.bodies[0].asleep:
                    break
            _, tilt = facet_below(body, moving.state.bodies[0])
            asleep += moving.state.bodies[0].asleep and tilt > 0.1
    yield Finding("asleep on a culet or an edge", asleep, 0)


def balanced() -> Iterator[Body]:
    """Each way, by so many radians beside the balance."""
    shape = brilliant()
    culet = shape.vertices[np.argmin(shape.vertices[:, 1])]
    stable = [facet for facet in stable_facets(shape) if shape.planes[facet, 1] < 0]
    ends = next(ends for one in stable for other in stable if one < other and len(ends := shared(one, other)) == 2)
    middle, along = ends.mean(axis=0), ends[1] - ends[0]
    along /= np.linalg.norm(along)
    foot = middle - along * (middle @ along)
    for down, axis in ((culet, (1.0, 0.0, 0.0)), (foot, triple(along))):
        upright = turning(triple(down / np.linalg.norm(down)), (0.0, -1.0, 0.0))
        for tilt in (1e-2, 1e-3, 0.0):
            yield standing("one", shape, product(upright, about(axis, tilt)))


def shared(one: int, other: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Corners of the brilliant that two of its facets have."""
    shape = brilliant()
    on = [abs(shape.vertices @ shape.planes[facet, :3] - shape.planes[facet, 3]) < 1e-9 for facet in (one, other)]
    found: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = shape.vertices[on[0] & on[1]]
    return found


def against_one_stone(count: int = 12) -> Iterator[Finding]:
    """The same drops by the solver of one stone, without and with rolling resistance: 50 ms after the first impact."""
    for rolling, name in ((0.0, ""), (0.02, ", rolling resistance")):
        worst = max(parted(seed, rolling) for seed in range(count))
        claim = f"{count} drops against the solver of one stone, 50 ms after impact{name}"
        yield Finding(claim, worst, 1e-3, "R and rad")


def parted(seed: int, rolling: float) -> float:
    """How far apart the two solvers' stones are then, R and radians."""
    rng, given = np.random.default_rng(seed), law(rolling_resistance=rolling)
    body = Body("one", brilliant(), (0.0, 1.5, 0.0), turned(rng), spin=triple(2 * rng.normal(size=3)))
    alone = World([body], law=given)
    several = beside_another(body, given, effort=SolverEffort(substeps=16, sweeps=60))
    after, falling = None, 0.0
    while after is None or alone.state.time < after + 0.05:
        alone.step()
        several.step()
        speed = alone.state.bodies[0].velocity[1]
        if after is None and speed > falling + 0.3:
            after = alone.state.time
        falling = speed
    return apart(alone.state.bodies[0], several.state.bodies[0])


def apart(one: BodyState, other: BodyState) -> float:
    """R and radians."""
    return math.dist(one.position, other.position) + angle_between(one.orientation, other.orientation)


def findings(*, quick: bool = False) -> Iterator[Finding]:
    """All of them; quick: fewer drops, a shorter rest."""
    yield from flight()
    yield from bounces()
    yield from sliding()
    yield from rest(5.0 if quick else 60.0)
    yield from drops(20 if quick else 300)
    yield from balancing()
    yield from against_one_stone(3 if quick else 12)
