"""Several stones at the ends of what is allowed: all stay finite, none passes through another, none gains energy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.simulation.bodies import Body
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.simulation.rigid_body.state import Triple
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS, Surface
from culet.simulation.world import World
from culet.study.contacts.finding import Finding
from culet.study.contacts.worlds import BOWL, Course, law, momenta, triple, turned, watch
from culet.study.solids import ball, box, brilliant, tetrahedron

OVERLAP = 1e-3
"""R, at any time."""
RISE = 1e-5
"""Of the energy, relative to that at the start."""

Stones = Callable[[np.random.Generator], Sequence[Body]]


@dataclass(frozen=True)
class ContactExtreme:
    """One case."""

    name: str
    stones: Stones
    settings: Mapping[str, object] = field(default_factory=dict)
    seconds: float = 4.0
    surfaces: tuple[Surface, ...] = (FLOOR,)
    overlap: float = OVERLAP
    final: float = OVERLAP
    """Overlap at the end, R."""
    rise: float | None = RISE
    """None: what is lifted out of an overlap rises."""
    thrown_at: bool = False
    """The first stone is thrown at the second along x: at the end it is behind it still, and both have moved."""

    def course(self) -> Course:
        """Let it run."""
        moving = World(self.stones(np.random.default_rng(3)), self.surfaces, law(**self.settings))
        return watch(moving, self.seconds)

    def findings(self) -> Iterator[Finding]:
        """What must hold of it."""
        course = self.course()
        yield Finding(f"{self.name}: finite", 0.0 if course.finite else math.nan, 0)
        yield Finding(f"{self.name}: fallen through the floor", course.fallen, 0)
        if self.thrown_at:
            yield Finding(f"{self.name}: passed through the other", _passed(course), 0)
        yield Finding(f"{self.name}: overlap", course.deepest, self.overlap, "R")
        yield Finding(f"{self.name}: overlap at the end", course.final, self.final, "R")
        if self.rise is not None:
            yield Finding(f"{self.name}: rise of energy", course.rise / max(abs(course.energy), 1e-9), self.rise)


def _passed(course: Course) -> int:
    (x, _, _), (other, *_) = course.positions
    return not x < other - 0.5 or other == 0


def few(count: int = 3, shape: Callable[[], Shape] = brilliant) -> Stones:
    """Above one another."""

    def stones(rng: np.random.Generator) -> Sequence[Body]:
        made = shape()
        return [
            Body(
                f"stone-{k}", made, (rng.uniform(-0.3, 0.3), 1.2 + 2.2 * k, rng.uniform(-0.3, 0.3)), turned(rng),
                spin=triple(rng.normal(size=3)),
            )
            for k in range(count)
        ]  # fmt: skip

    return stones


def pair(at: Triple, other: Triple, velocity: Triple = (0.0, 0.0, 0.0), spin: Triple = (0.0, 0.0, 0.0)) -> Stones:
    """Two brilliants, turned at random; the motion is the first one's."""
    return lambda rng: [
        Body("one", brilliant(), at, turned(rng), velocity, spin),
        Body("other", brilliant(), other, turned(rng)),
    ]


def doubled() -> Shape:
    """A brilliant whose file has each corner three times, two of them 1e-7 R aside."""
    shape, rng = brilliant(), np.random.default_rng(0)
    corner = [shape.vertices, *(shape.vertices + 1e-7 * rng.normal(size=shape.vertices.shape) for _ in range(2))]
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.concatenate(corner).tolist()]
    copy = rng.integers(3, size=shape.triangles.shape) * len(shape.vertices)
    lines += [f"f {a} {b} {c}" for a, b, c in (shape.triangles + copy + 1).tolist()]
    return shape_from_mesh("\n".join(lines).encode(), "obj", name="doubled corners")


def heavy(rng: np.random.Generator) -> Sequence[Body]:
    """1e4 times the mass falls on a stone."""
    return [
        Body("light", brilliant(), (0.0, 0.2, 0.0), turned(rng)),
        Body("heavy", brilliant(), (0.0, 2.6, 0.0), turned(rng), mass=1e4),
    ]


def sizes(rng: np.random.Generator) -> Sequence[Body]:
    """Eight stones of a twentieth on a large one."""
    small = [
        Body(f"small-{k}", brilliant(), (0.3 * math.cos(k), 2.5 + 0.15 * k, 0.3 * math.sin(k)), turned(rng), scale=0.05)
        for k in range(8)
    ]
    return [Body("large", brilliant(), (0.0, 1.0, 0.0), turned(rng), mass=8000.0), *small]


def column(rng: np.random.Generator) -> Sequence[Body]:
    """Twelve above one another."""
    return [
        Body(f"stone-{k}", brilliant(), (rng.uniform(-0.6, 0.6), 1 + 2.1 * k, rng.uniform(-0.6, 0.6)), turned(rng))
        for k in range(12)
    ]


def coincident(_: np.random.Generator) -> Sequence[Body]:
    """Two in one place."""
    return [Body(name, brilliant(), (0.0, 0.3, 0.0), IDENTITY) for name in ("one", "other")]


AWAY = (30.0, 0.0, 0.0)
"""Where a second stone takes no part."""
ROOM = (FLOOR, *WALLS)

EXTREMES = (
    ContactExtreme("gravity x 1000", few(), {"gravity": 9810}, 2.0),
    ContactExtreme(
        "gravity 1e6, steps of 0.25 s",
        few(),
        {"gravity": 1e6, "time_step": 0.25},
        5.0,
        overlap=1e-1,
        final=5e-2,
        rise=1e-2,
    ),
    ContactExtreme("gravity 0, thrown", pair((0.0, 2.0, 0.0), (0.2, 5.0, 0.0), (0.0, 3.0, 0.0)), {"gravity": 0}),
    ContactExtreme("mass 1e4 on 1", heavy, seconds=6.0, overlap=1e-1),
    ContactExtreme("sizes 1 to 20", sizes, seconds=6.0),
    ContactExtreme("spin of 100 rad/s", pair((0.0, 0.5, 0.0), AWAY, spin=(60.0, 60.0, -53.0))),
    ContactExtreme("spin of 100 rad/s, at a stone", pair((0.2, 3.0, 0.0), (0.0, 0.5, 0.0), spin=(100.0, 0.0, 0.0))),
    ContactExtreme("50 R/s at the floor", pair((0.0, 3.0, 0.0), AWAY, (5.0, -50.0, 0.0)), seconds=2.0),
    ContactExtreme(
        "50 R/s at a stone",
        pair((-6.0, 0.5, 0.0), (0.0, 0.5, 0.0), (50.0, 0.0, 0.0)),
        {"gravity": 0},
        2.0,
        thrown_at=True,
    ),
    ContactExtreme("400 R/s at the floor", pair((0.0, 3.0, 0.0), AWAY, (5.0, -400.0, 0.0)), seconds=2.0),
    ContactExtreme(
        "400 R/s at a stone",
        pair((-6.0, 0.5, 0.0), (0.0, 0.5, 0.0), (400.0, 0.0, 0.0)),
        {"gravity": 0},
        2.0,
        thrown_at=True,
    ),
    ContactExtreme(
        "2000 R/s at a wall", pair((0.0, 3.0, 0.0), (3.0, 0.0, 3.0), (0.0, 0.0, -2000.0)), seconds=1.0, surfaces=ROOM
    ),
    ContactExtreme(
        "2000 R/s at a stone",
        pair((-6.0, 0.5, 0.0), (0.0, 0.5, 0.0), (2000.0, 0.0, 0.0)),
        {"gravity": 0},
        1.0,
        thrown_at=True,
    ),
    ContactExtreme("needles 20 : 1", few(4, box(1, 0.05, 0.05)), seconds=6.0),
    ContactExtreme("needles 1000 : 1", few(2, box(1, 1e-3, 1e-3))),
    ContactExtreme("wafers 20 : 1", few(4, box(1, 0.05, 1)), seconds=6.0),
    ContactExtreme("wafers 1000 : 1", few(2, box(1, 1e-3, 1))),
    ContactExtreme("300 facets", few(4, ball(300)), seconds=5.0),
    ContactExtreme("doubled corners", few(3, doubled), seconds=5.0),
    ContactExtreme("tetrahedra", few(5, tetrahedron), seconds=5.0),
    ContactExtreme("start 0.3 R in each other", pair((0.0, 0.3, 0.0), (0.3, 1.3, 0.0)), overlap=1.0, rise=None),
    ContactExtreme("start in one place", coincident, overlap=2.0, rise=None),
    ContactExtreme("start 0.5 R in the floor", pair((0.0, -0.6, 0.0), AWAY), seconds=3.0, overlap=1.0, rise=None),
    ContactExtreme("steps of 1/30 s", few(4), {"time_step": 1 / 30}, 6.0, overlap=1e-1),
    ContactExtreme("steps of 1/30 s, heap of 12", column, {"time_step": 1 / 30}, 8.0, BOWL, overlap=1e-1),
    ContactExtreme("friction 10, restitution 1", few(), {"friction": 10, "restitution": 1}, 6.0),
    ContactExtreme("restitution 1, heap of 6", few(6), {"friction": 0, "restitution": 1}, 8.0, BOWL, rise=2e-3),
)


def leaving_speed(case: str) -> Finding:
    """Of stones that start in an overlap, after the first step: no faster than one step of gravity makes them."""
    extreme = next(each for each in EXTREMES if each.name == case)
    moving = World(extreme.stones(np.random.default_rng(3)), extreme.surfaces, law(**extreme.settings))
    moving.step()
    speed = max(math.hypot(*state.velocity) for state in moving.state.bodies)
    return Finding(f"{case}: speed after a step", speed, moving.law.gravity * moving.law.time_step * (1 + 1e-9), "R/s")


SPINNING = {
    "needles 1000 : 1": (box(1, 1e-3, 1e-3), 5e-4),
    "needles 20 : 1": (box(1, 0.05, 0.05), 0.05),
    "wafers 20 : 1": (box(1, 0.05, 1), 0.05),
    "brilliants": (brilliant, 0.3),
}
"""Two of them, and how far their centres of mass are from each other, R."""


def spinning_starts(seeds: Sequence[int] = range(20)) -> Iterator[Finding]:
    """Of two that start in each other and spin at some 15 rad/s, without gravity: the worst until they are apart."""
    for kind, (shape, way) in SPINNING.items():
        made, rise, deepest, impulse = shape(), 0.0, 0.0, 0.0
        for seed in seeds:
            rng = np.random.default_rng(seed)
            places = {"one": (0.0, 0.0, 0.0), "other": (0.0, way, 0.0)}
            stones = [
                Body(name, made, at, turned(rng), spin=triple(15 * rng.normal(size=3))) for name, at in places.items()
            ]
            moving = World(stones, (), law(gravity=0))
            course = watch(moving, 0.5, every=60)
            rise, deepest = max(rise, course.rise / course.energy), max(deepest, course.final)
            impulse = max(impulse, float(np.linalg.norm(momenta(moving)[0])))
        yield Finding(f"spinning {kind} that start in each other, rise of energy, relative", rise, RISE)
        yield Finding(f"spinning {kind} that start in each other, momentum, R/s", impulse, 1e-12)
        yield Finding(f"spinning {kind} that start in each other, overlap after 0.5 s", deepest, 2e-5, "R")


def findings() -> Iterator[Finding]:
    """All of them."""
    for extreme in EXTREMES:
        yield from extreme.findings()
        if extreme.rise is None:
            yield leaving_speed(extreme.name)
