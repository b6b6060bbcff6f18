"""`python -m culet.study.motion.motion_extremes`: drops at the ends of what is allowed, and what is refused.

What must hold of each, after every step: all numbers are finite; the energy is never above what it was before, but for
rounding; no vertex is inside a surface, at any speed; the centre of mass is no faster than all the energy there is,
without the potential of lying on the floor, could make it; and a stone that starts inside a surface leaves it
no faster than its throw and one step of gravity make it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from culet.errors import CuletError
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.scene.legacy import legacy
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.motion import BodyMotion, kinetic_energy, pushed_out
from culet.simulation.rigid_body.rotation import rotate
from culet.simulation.rigid_body.settings import SimulationSettings as Settings
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS, Surface
from culet.study.solids import ball, box, brilliant, tetrahedron

GAIN = 1e-6
"""Of the energy above lying on the floor: rounding, and the fourth order of the rotation."""
DEPTH = 1e-4
"""R."""
TILT: Quaternion = (0.9238795325112867, 0.3826834323650898, 0.0, 0.0)
"""45 degrees about x."""
ROOM = (FLOOR, *WALLS)
CORNER = (FLOOR, Surface((1.0, 0.0, 0.0), -1.0), Surface((0.0, 0.0, 1.0), -1.0))


def leaning(angle: float) -> Quaternion:
    """By so many radians from the x axis, up."""
    return (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))


@dataclass(frozen=True)
class DropExtreme:
    """One case: settings that are not the scene's default, a stone and where it starts."""

    name: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    shape: Callable[[], Shape] = brilliant
    position: Triple = (0.0, 1.5, 0.0)
    orientation: Quaternion = TILT
    surfaces: tuple[Surface, ...] = ROOM
    on_floor: bool = False
    """Lowered, or lifted, until its lowest vertex touches the floor."""
    steps: int = 300

    def begun(self) -> Simulation:
        """At the start."""
        shape, (x, y, z) = self.shape(), self.position
        if self.on_floor:
            y = FLOOR.offset - min(rotate(self.orientation, (a, b, c))[1] for a, b, c in shape.vertices.tolist())
        settings = Settings.model_validate(self.settings)
        return Simulation(settings, shape, (x, y, z), self.orientation, self.surfaces)


@dataclass(frozen=True)
class DropRecord:
    """What the steps of one case came to."""

    finite: bool = True
    gain: float = 0.0
    """Largest rise of the energy above the lowest before, relative to that above lying on the floor."""
    depth: float = 0.0
    """How far a vertex was inside a surface, R."""
    fastest: float = 0.0
    """Of the centre of mass, R/s."""
    bound: float = 0.0
    """R/s. What it could have been."""
    exit_speed: float | None = None
    """After the first step of a stone that starts inside a surface, R/s; at most `exit_bound`."""
    exit_bound: float = 0.0
    coarse: int = 0
    asleep: bool = False

    @property
    def held(self) -> bool:
        """Whether everything that must hold does."""
        left_slowly = self.exit_speed is None or self.exit_speed <= self.exit_bound
        return self.finite and self.gain <= GAIN and self.depth <= DEPTH and self.fastest <= self.bound and left_slowly


EXTREMES = (
    DropExtreme("gravity 0, thrown down", {"gravity": 0, "velocity": (0, -3, 0)}),
    DropExtreme("gravity 1e6 R/s^2", {"gravity": 1e6}),
    DropExtreme("gravity 1e6 R/s^2, steps of 0.25 s", {"gravity": 1e6, "time_step": 0.25}),
    DropExtreme(
        "gravity 1e6 R/s^2, no friction, no sleep", {"gravity": 1e6, "friction": 0, "sleeping": False}, steps=5
    ),
    DropExtreme("mass 1e-9", {"mass": 1e-9}),
    DropExtreme("mass 1e9", {"mass": 1e9}),
    DropExtreme("restitution 0", {"restitution": 0}),
    DropExtreme("restitution 1", {"restitution": 1}),
    DropExtreme("friction 0", {"friction": 0}),
    DropExtreme("friction 1e3", {"friction": 1e3}),
    DropExtreme("friction 1e3, restitution 1", {"friction": 1e3, "restitution": 1}),
    DropExtreme("steps of 1e-4 s", {"time_step": 1e-4}, position=(0.0, -0.1, 0.0)),
    DropExtreme("steps of 0.25 s", {"time_step": 0.25}),
    DropExtreme("spin of 1 rad a step", {"spin": (60, 90, 40)}),
    DropExtreme("spin of 100 rad a step", {"spin": (6000, 9000, 4000)}),
    DropExtreme("spin 1e9 rad/s", {"spin": (1e9, 1e9, -1e9)}),
    DropExtreme("thrown at a wall, 1e4 R/s", {"velocity": (0, 0, -1e4)}),
    DropExtreme("thrown, 1e9 R/s", {"velocity": (1e9, -1e9, -1e9)}),
    DropExtreme("needle, 1000 : 1", shape=box(1, 1e-3, 1e-3)),
    DropExtreme("needle, 1000 : 1, restitution 1", {"restitution": 1}, box(1, 1e-3, 1e-3)),
    DropExtreme("wafer, 1000 : 1", shape=box(1, 1e-3, 1)),
    DropExtreme("wafer, 1000 : 1, restitution 1", {"restitution": 1}, box(1, 1e-3, 1)),
    DropExtreme("tetrahedron", shape=tetrahedron),
    DropExtreme("tetrahedron, restitution 1", {"restitution": 1}, tetrahedron),
    DropExtreme("near-sphere, 2000 vertices", shape=ball(1002)),
    DropExtreme("near-sphere, 2000 vertices, restitution 1", {"restitution": 1}, ball(1002)),
    DropExtreme("start 1 R below the floor, at rest", {"spin": (0, 0, 0)}, position=(0.0, -2.0, 0.0)),
    DropExtreme(
        "start 1 R below the floor, at rest, gravity 1e6 R/s^2",
        {"spin": (0, 0, 0), "gravity": 1e6},
        position=(0.0, -2.0, 0.0),
    ),
    DropExtreme(
        "start 0.5 R behind each of three planes, at rest",
        {"spin": (0, 0, 0)},
        position=(-1.5, -1.5, -1.5),
        surfaces=CORNER,
    ),
    DropExtreme(
        "start 2 R below the floor, thrown out, no spin, gravity 0",
        {"gravity": 0, "velocity": (0, 1, 0), "spin": (0, 0, 0)},
        position=(0.0, -3.0, 0.0),
    ),
    DropExtreme(
        "start 2 R below the floor, thrown along it, no spin, gravity 0",
        {"gravity": 0, "velocity": (1, 0, 0), "spin": (0, 0, 0)},
        position=(0.0, -3.0, 0.0),
    ),
    DropExtreme(
        "start inside a wall, thrown out, no spin",
        {"velocity": (0, 0, 1), "spin": (0, 0, 0)},
        position=(0.0, 1.5, -8.5),
    ),
    DropExtreme(
        "on the floor, thrown up, no spin", {"velocity": (0, 3, 0), "spin": (0, 0, 0)}, surfaces=(FLOOR,), on_floor=True
    ),
    DropExtreme("dropped into a corner of three planes", {"velocity": (-3, 0, -3)}, surfaces=CORNER),
    *(
        DropExtreme(
            f"Painlevé's rod, 100 : 1, friction {friction:g}, {speed:+g} R/s",
            {"friction": friction, "velocity": (speed, 0, 0), "spin": (0, 0, 0), "restitution": 0},
            box(1, 1e-2, 1e-2),
            orientation=leaning(0.8),
            surfaces=(FLOOR,),
            on_floor=True,
        )
        for friction, speed in itertools.product((1.5, 1e3), (-5, 5))
    ),
)


def recorded(extreme: DropExtreme) -> DropRecord:
    """Let a case run."""
    moving = extreme.begun()
    body, settings, start = moving.body, moving.settings, moving.state
    weight = body.mass * settings.gravity
    begun = BodyMotion(start.position, start.orientation, start.momentum, start.angular_momentum)
    lifted = pushed_out(begun, body)
    inside = lifted != begun
    lowest = kinetic_energy(lifted, body) + weight * (lifted.position[1] - FLOOR.offset - 1)
    above_floor = lowest + weight
    bound = math.sqrt(2 * above_floor / body.mass) * (1 + GAIN)
    gain = depth = fastest = 0.0
    finite, exit_speed = True, None
    for _ in range(extreme.steps):
        moving.step()
        state, energy = moving.state, moving.energy()
        numbers = (*state.position, *state.orientation, *state.momentum, *state.angular_momentum, energy)
        finite = finite and all(map(math.isfinite, numbers))
        gain, lowest = max(gain, (energy - lowest) / above_floor), min(lowest, energy)
        depth, speed = max(depth, moving.touch().penetration), math.hypot(*body.velocity(state))
        fastest = max(fastest, speed)
        if inside and exit_speed is None:
            exit_speed = speed
    exit_bound = math.hypot(*settings.velocity) + settings.gravity * settings.time_step
    coarse, asleep = moving.state.coarse, moving.state.asleep
    return DropRecord(finite, gain, depth, fastest, bound, exit_speed, exit_bound, coarse, asleep)


def flat_mesh() -> object:
    """Four corners in a plane, but for 1e-9 R."""
    return shape_from_mesh(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e-9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "obj")


def mesh_of_nan() -> object:
    """A corner that is nowhere."""
    return shape_from_mesh(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 nan\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "obj")


def _read(**settings: object) -> Callable[[], object]:
    of_stones = {name: value for name, value in settings.items() if name in ("mass", "spin")}
    laws = {name: value for name, value in settings.items() if name not in of_stones}
    return lambda: legacy({"simulation": laws, "stones": [of_stones]})


REFUSED: Mapping[str, Callable[[], object]] = {
    "a stone without volume": flat_mesh,
    "a mesh with NaN": mesh_of_nan,
    "a start at NaN": lambda: Simulation(Settings(), brilliant(), (0.0, math.nan, 0.0), TILT),
    "a start without an orientation": lambda: Simulation(Settings(), brilliant(), (0.0, 0.0, 0.0), (0.0,) * 4),
    "gravity NaN": _read(gravity=math.nan),
    "gravity 1e7": _read(gravity=1e7),
    "mass 0": _read(mass=0),
    "spin infinite": _read(spin=(0, math.inf, 0)),
    "restitution 1.1": _read(restitution=1.1),
    "friction -1": _read(friction=-1),
    "steps of 1 s": _read(time_step=1),
}


def refusal(case: str) -> str | None:
    """What a case of REFUSED is told; None if it is not refused."""
    try:
        REFUSED[case]()
    except CuletError as error:
        return str(error)
    return None


def table() -> Iterator[str]:
    """Lines of Markdown: for each case what was measured, with its bound."""
    yield (
        f"| case | finite | energy gain (at most {GAIN:g}) | deepest, R (at most {DEPTH:g}) | fastest, R/s (at most) "
        "| left at, R/s (at most) | coarse steps | asleep | held |"
    )
    yield "|---|---|---|---|---|---|---|---|---|"
    for extreme in EXTREMES:
        found = recorded(extreme)
        left = "" if found.exit_speed is None else f"{found.exit_speed:.3g} ({found.exit_bound:.3g})"
        yield (
            f"| {extreme.name} | {_yes(found.finite)} | {found.gain:.0e} | {found.depth:.0e} "
            f"| {found.fastest:.3g} ({found.bound:.3g}) | {left} | {found.coarse} | {_yes(found.asleep)} "
            f"| {_yes(found.held)} |"
        )


def refusals() -> Iterator[str]:
    """Lines of Markdown: what is refused, and in which words."""
    yield "| refused | in these words |"
    yield "|---|---|"
    for case in REFUSED:
        yield f"| {case} | {refusal(case) or '**not refused**'} |"


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"


if __name__ == "__main__":
    for line in itertools.chain(table(), [""], refusals()):
        print(line, flush=True)
