"""Stones on stones: what an impact keeps, a cradle, a stack."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from culet.simulation.bodies import Body
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.simulation.world import World
from culet.study.contacts.finding import Finding
from culet.study.contacts.worlds import about, advance, angle_between, law, level, momenta, overlap, standing, step_cut
from culet.study.solids import box, brilliant

CUBE = box(1, 1, 1)
SIDE = 1 / math.sqrt(3)
"""Half of the cube's, R."""


def impacts() -> Iterator[Finding]:
    """Without gravity: two cubes face to face, two brilliants beside each other's centre, smooth and rough."""
    lost, turned, gained, ratio = 0.0, 0.0, 0.0, 0.0
    for shape, restitution, friction, aside in (
        (CUBE(), 1.0, 0.0, 0.0),
        (CUBE(), 0.6, 0.3, 0.0),
        (brilliant(), 1.0, 0.0, 0.3),
        (brilliant(), 0.6, 0.3, 0.3),
    ):
        other = about((0.0, 0.0, 1.0), 0.4) if aside else IDENTITY
        bodies = (
            Body("one", shape, (-2.0, 0.0, 0.0), IDENTITY, (2.0, 0.0, 0.0)),
            Body("other", shape, (2.0, aside, 0.0), other, (-1.0, 0.0, 0.0), mass=1.5),
        )
        given = law(gravity=0, restitution=restitution, friction=friction, sleeping=False)
        moving = World(bodies, (), given)
        (linear, angular), energy = momenta(moving), moving.energy()
        advance(moving, 3)
        after, after_angular = momenta(moving)
        lost = max(lost, float(np.linalg.norm(after - linear) / np.linalg.norm(linear)))
        turned = max(turned, float(np.linalg.norm(after_angular - angular)) / max(float(np.linalg.norm(angular)), 1.0))
        if restitution == 1:
            gained = max(gained, abs(moving.energy() / energy - 1))
        if not aside:
            first, second = moving.state.bodies
            ratio = max(ratio, abs((second.velocity[0] - first.velocity[0]) / 3 - restitution))
    yield Finding("impacts of two, momentum, relative", lost, 1e-12)
    yield Finding("impacts of two, angular momentum, relative", turned, 1e-5)
    yield Finding("elastic impacts of two, energy, relative", gained, 1e-6)
    yield Finding("impacts of two cubes, ratio of speeds", ratio, 1e-4)


def cradle() -> Iterator[Finding]:
    """Three equal cubes in a row, the last at a gap: only the last moves on."""
    places = (-2 * SIDE - 1, 0.0, 2 * SIDE + 0.05)
    bodies = [
        Body(f"cube-{k}", CUBE(), (x, 0.0, 0.0), IDENTITY, (0.0 if k else 2.0, 0.0, 0.0)) for k, x in enumerate(places)
    ]
    moving = World(bodies, (), law(gravity=0, restitution=1, friction=0, sleeping=False))
    advance(moving, 1.2)
    speeds = [state.velocity[0] / 2 for state in moving.state.bodies]
    error = max(abs(speed - expected) for speed, expected in zip(speeds, (0.0, 0.0, 1.0), strict=True))
    yield Finding("cradle with a gap, speeds 0, 0, 1", error, 1e-6)


def stack() -> Iterator[Finding]:
    """Three step cuts, each a little aside of the one below, dropped on one another."""
    shape = step_cut()
    orientation = level(shape, int(np.argmin(shape.planes[:, 1])))
    height = float(np.ptp(shape.vertices[:, 1]))
    lowest = standing("stone-0", shape, orientation)
    x, y, z = lowest.position
    bodies = [Body(f"stone-{k}", shape, (x + 0.02 * k, y + k * (height + 0.02), z), orientation) for k in range(3)]
    moving = World(bodies, law=law(restitution=0.3, rolling_resistance=0.02))
    deepest = -math.inf
    while not moving.settled and moving.state.time < 10:
        moving.step()
        deepest = max(deepest, overlap(moving))
    tilt = max(angle_between(orientation, state.orientation) for state in moving.state.bodies)
    slid = max(
        math.hypot(state.position[0] - body.position[0], state.position[2] - body.position[2])
        for body, state in zip(bodies, moving.state.bodies, strict=True)
    )
    yield Finding("stack of three step cuts, tilt", math.degrees(tilt), 0.05, "degrees")
    yield Finding("stack of three step cuts, asleep after", moving.state.time, 2, "s")
    yield Finding("stack of three step cuts, slid", slid, 1e-2, "R")
    yield Finding("stack of three step cuts, overlap", deepest, 1e-3, "R")


def findings() -> Iterator[Finding]:
    """All of them."""
    yield from impacts()
    yield from cradle()
    yield from stack()
