"""Where several stones come to rest, here and in Rapier and MuJoCo, whose contacts are softer; overlaps by coal.

Paths of single stones part within seconds, so what is compared is what they cannot change: how high a stack is, and how
high the stones of a heap lie on the average.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from culet.simulation.bodies import Body
from culet.simulation.rigid_body.rotation import rotate
from culet.simulation.rigid_body.surfaces import FLOOR, Surface
from culet.simulation.world import World
from culet.study.contacts.heaps import scattered
from culet.study.contacts.worlds import BOWL, advance, law, level, standing, step_cut, triple, turned
from culet.study.solids import brilliant
from validation.other_engines import FRICTION, MISSING, Positions, mujoco, rapier

pytestmark = pytest.mark.validation

Engine = Callable[[Sequence[Body], Sequence[Surface], float], Positions]
ENGINES: dict[str, Engine] = {"rapier": rapier, "mujoco": mujoco}


def here(bodies: Sequence[Body], surfaces: Sequence[Surface], seconds: float) -> Positions:
    moving = World(bodies, surfaces, law(restitution=0, friction=FRICTION, rolling_resistance=0.02))
    advance(moving, seconds)
    return np.array([state.position for state in moving.state.bodies])


@pytest.mark.parametrize("engine", ENGINES)
def test_a_stack_is_as_high(engine: str) -> None:
    """Rapier lets stones overlap by up to 1e-2 R; MuJoCo, with contacts this stiff, by 1e-4 R."""
    shape = step_cut()
    lowest = standing("stone-0", shape, level(shape, int(np.argmin(shape.planes[:, 1]))))
    x, y, z = lowest.position
    height = float(np.ptp(shape.vertices[:, 1]))
    bodies = [replace(lowest, name=f"stone-{k}", position=(x, y + k * (height + 0.01), z)) for k in range(3)]
    ours, theirs = here(bodies, (FLOOR,), 2.0), ENGINES[engine](bodies, (FLOOR,), 2.0)
    assert ours[:, 1] == pytest.approx(theirs[:, 1], abs=3e-2 if engine == "rapier" else 2e-3)


@pytest.mark.parametrize("engine", ENGINES)
def test_stones_of_a_heap_lie_as_high(engine: str) -> None:
    heights: dict[str, list[float]] = {"here": [], engine: []}
    for seed in range(4):
        bodies = [replace(body, spin=(0.0, 0.0, 0.0)) for body in scattered(8, brilliant(), seed)]
        heights["here"].append(float(here(bodies, BOWL, 8.0)[:, 1].mean()))
        heights[engine].append(float(ENGINES[engine](bodies, BOWL, 8.0)[:, 1].mean()))
    ours, theirs = np.array(heights["here"]), np.array(heights[engine])
    print(f"here {ours.round(3)}, {engine} {theirs.round(3)}")
    spread = np.sqrt((ours.var(ddof=1) + theirs.var(ddof=1)) / len(ours))
    assert abs(ours.mean() - theirs.mean()) < max(3 * spread, 0.03)


def test_two_stones_overlap_as_deep_as_coal_says() -> None:
    """By coal's GJK and EPA, in double precision: another way to the same number."""
    coal = pytest.importorskip("coal", reason=MISSING.format("coal"))
    shape, rng = brilliant(), np.random.default_rng(11)
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for corner in shape.vertices:
        corners.append(corner)
    for triangle in shape.triangles.tolist():
        triangles.append(coal.Triangle(*triangle))
    hull, compared, worst = coal.Convex(corners, triangles), 0, 0.0
    for _ in range(200):
        bodies = [
            Body(name, shape, triple(0.4 * rng.normal(size=3)), turned(rng)) for name in ("one", "other")
        ]  # fmt: skip
        poses = [coal.Transform3s(axes_of(body), np.array(body.position)) for body in bodies]
        result = coal.CollisionResult()
        if coal.collide(hull, poses[0], hull, poses[1], coal.CollisionRequest(), result):
            depth = World(bodies, ()).separation("one", "other")
            worst = max(worst, abs(result.getContact(0).penetration_depth - depth))
            compared += 1
    assert compared > 100
    assert worst < 1e-12  # measured 9e-16


def axes_of(body: Body) -> Positions:
    """The rotation matrix of its orientation."""
    return np.array([rotate(body.orientation, axis) for axis in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))]).T
