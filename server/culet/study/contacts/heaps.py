"""Heaps of stones in a bowl of three walls: overlaps, energy, sleep, and what they cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from time import thread_time

import numpy as np

from culet.geometry.shape import Shape
from culet.simulation.bodies import Body
from culet.simulation.world import World
from culet.study.contacts.finding import Finding
from culet.study.contacts.worlds import BOWL, G, advance, law, overlap, triple, turned
from culet.study.solids import box, brilliant

SEEDS = (1, 2, 3, 4, 5)
DEEPEST = {12: 1e-3, 32: 2e-3, 64: 5e-3}
"""R, at any time; by the number of stones."""
ASLEEP = {12: 14.0, 32: 15.0, 64: 20.0}
"""s, the latest."""
THIN = {
    "needles 20 : 1": box(1, 0.05, 0.05),
    "wafers 20 : 1": box(1, 0.05, 1),
    "needles 1000 : 1": box(1, 1e-3, 1e-3),
    "wafers 1000 : 1": box(1, 1e-3, 1),
}
THIN_HEAPS = (*((kind, 12) for kind in THIN), ("needles 20 : 1", 32), ("wafers 20 : 1", 32))
THIN_ASLEEP = 25.0
"""s, the latest: what leans waits until it is clear that it does not fall."""
COST = {12: 6.0, 32: 18.0, 64: 42.0}
"""Of the dearest quarter of the steps, in units of what one stone in contact costs by the solver of one: less than so
many stones that lie alone. While Python found the impulses of one stone, its step took 3.4 times as long: 2, 6, 14."""


def scattered(count: int, shape: Shape, seed: int) -> list[Body]:
    """In layers of four above the bowl, turned and spinning at random."""
    rng, bodies = np.random.default_rng(seed), []
    for number in range(count):
        layer, place = divmod(number, 4)
        angle, way = place * math.pi / 2 + layer * 0.5, 1.15 * math.sqrt(2) * 1.05
        x, z = way * math.cos(angle) + rng.uniform(-0.05, 0.05), way * math.sin(angle) + rng.uniform(-0.05, 0.05)
        orientation, velocity = turned(rng), triple(0.2 * rng.normal(size=3))
        spin = triple(2 * rng.normal(size=3))
        bodies.append(Body(f"stone-{number}", shape, (x, 2.3 + 2.3 * layer, z), orientation, velocity, spin))
    return bodies


def heap(count: int, seed: int, shape: Shape | None = None) -> World:
    """At its start, by the scene's default law."""
    return World(scattered(count, shape or brilliant(), seed), BOWL, law(rolling_resistance=0.02))


@dataclass(frozen=True)
class _Fall:
    """What has come of a heap."""

    ever: float
    """Overlap at any time, R."""
    settled: float
    """Overlap at rest, R."""
    rise: float
    """Of the energy above the lowest before, mass R^2/s^2."""
    energy: float
    """At the start."""
    asleep_after: float
    """s; where some are awake still, as long as it was looked at."""
    drift: float
    """Of any in the second after that, R."""


def _fall(moving: World, patience: float) -> _Fall:
    start = lowest = moving.energy()
    ever = rise = 0.0
    while not moving.settled and moving.state.time < patience:
        moving.step()
        energy = moving.energy()
        rise, lowest = max(rise, energy - lowest), min(lowest, energy)
        if moving.state.step % 10 == 0:
            ever = max(ever, overlap(moving))
    settled, asleep_after = overlap(moving), moving.state.time
    before = [state.position for state in moving.state.bodies]
    advance(moving, 1)
    drift = max(math.dist(a, b.position) for a, b in zip(before, moving.state.bodies, strict=True))
    return _Fall(max(ever, settled), settled, rise, start, asleep_after, drift)


def heaps(count: int, seeds: tuple[int, ...] = SEEDS) -> Iterator[Finding]:
    """The worst of some heaps of so many."""
    falls = [_fall(heap(count, seed), ASLEEP[count] + 10) for seed in seeds]
    name = f"heaps of {count}"
    yield Finding(f"{name}, overlap at any time", max(fall.ever for fall in falls), DEEPEST[count], "R")
    yield Finding(f"{name}, overlap at rest", max(fall.settled for fall in falls), 2e-5, "R")
    yield Finding(f"{name}, rise of energy", max(fall.rise for fall in falls) / G, 1e-5, "m g R")
    yield Finding(f"{name}, all asleep after", max(fall.asleep_after for fall in falls), ASLEEP[count], "s")
    yield Finding(f"{name}, drift asleep", max(fall.drift for fall in falls), 0, "R")


def thin_heaps(kind: str, count: int, seeds: tuple[int, ...] = SEEDS) -> Iterator[Finding]:
    """The worst of some heaps of so many needles or wafers, held to what extremes are held to."""
    shape = THIN[kind]()
    falls = [_fall(heap(count, seed, shape), THIN_ASLEEP + 5) for seed in seeds]
    name = f"heaps of {count} {kind}"
    yield Finding(f"{name}, overlap at any time", max(fall.ever for fall in falls), 1e-3, "R")
    yield Finding(f"{name}, overlap at rest", max(fall.settled for fall in falls), 2e-5, "R")
    rise = max(fall.rise / fall.energy for fall in falls)
    yield Finding(f"{name}, rise of energy, of that at the start", rise, 1e-5)
    yield Finding(f"{name}, all asleep after", max(fall.asleep_after for fall in falls), THIN_ASLEEP, "s")
    yield Finding(f"{name}, drift asleep", max(fall.drift for fall in falls), 0, "R")


def cost_of_one(seeds: tuple[int, ...] = (0, 1, 2)) -> float:
    """s of the processor for a step of one brilliant that touches the floor and moves, by the solver of one stone.

    The mean over drops as those of a scene, from where they touch first until they sleep.
    """
    times = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        body = Body("one", brilliant(), (0.0, 1.5, 0.0), turned(rng), spin=triple(2 * rng.normal(size=3)))
        moving = World([body], law=law(rolling_resistance=0.02))
        while not moving.settled:
            begun = thread_time()
            moving.step()
            taken = thread_time() - begun
            if moving.touches()[0].contacts and not moving.state.asleep:
                times.append(taken)
    return sum(times) / len(times)


def dearest_quarter(moving: World, seconds: float) -> float:
    """s of the processor for a step, in the mean of the dearest quarter."""
    times = []
    while moving.state.time < seconds and not moving.settled:
        begun = thread_time()
        moving.step()
        times.append(thread_time() - begun)
    times += [0.0] * (round(seconds / moving.law.time_step) - len(times))
    dearest = sorted(times)[-len(times) // 4 :]
    return sum(dearest) / len(dearest)


def costs(count: int, seed: int = 1) -> Iterator[Finding]:
    """Beside one stone of the solver of one, in the same run, before and after."""
    before = cost_of_one()
    several = dearest_quarter(heap(count, seed), 14.0)
    one = min(before, cost_of_one())
    yield Finding(f"a heap of {count}, its dearest quarter beside one stone", several / one, COST[count])
