"""Substeps that differ in length: fast thin stones divide them for all others, and a scene may ask for other steps."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.simulation.bodies import Body
from culet.simulation.rigid_body.rotation import IDENTITY
from culet.simulation.rigid_body.surfaces import FLOOR, Surface
from culet.study.contacts.worlds import about, advance, stable_facets, standing, triple, turning
from culet.study.solids import box, brilliant
from simulation.worlds import world


def lying(shape: Shape) -> Body:
    """On a facet on which it can stay."""
    facet = stable_facets(shape)[0]
    return standing("lying", shape, turning(triple(shape.planes[facet, :3]), (0.0, -1.0, 0.0)))


def twins(spin: float, gap: float) -> list[Body]:
    """Two needles that spin beside each other and fall together, far away: none of them touches anything, and where
    they might divides each substep."""
    needle = box(1, 1e-3, 1e-3)()
    return [
        Body(name, needle, (40.0, 9.0 + height, 0.0), IDENTITY, spin=(0.0, spin, 0.0))
        for name, height in (("upper", gap), ("lower", 0.0))
    ]


def cubes(count: int) -> list[Body]:
    """Above one another, none quite as the others."""
    cube, rng = box(1, 1, 1)(), np.random.default_rng(0)
    side = 2 * float(cube.vertices[:, 1].max())
    return [
        Body(
            f"cube-{k}", cube, (0.02 * k, FLOOR.offset + side / 2 + 1e-4 + k * (side + 0.002), 0.0),
            about(triple(rng.normal(size=3)), 0.01 * k), (0.0, -1.0, 0.0),
        )
        for k in range(count)
    ]  # fmt: skip


@pytest.mark.parametrize(("spin", "gap"), [(60.0, 0.01), (100.0, 0.01), (230.0, 0.012), (400.0, 0.02)])
def test_a_stone_lies_as_still_where_others_divide_its_substeps(spin: float, gap: float) -> None:
    moving = world([lying(brilliant()), *twins(spin, gap)], sleeping=False)
    advance(moving, 0.5)
    fastest = 0.0
    for _ in range(20):
        moving.step()
        state = moving.state.bodies[0]
        fastest = max(fastest, math.hypot(*state.velocity) + math.hypot(*state.spin))
    assert fastest < 1e-12  # R/s; 3e-19. With the impulses of another length as they are: up to 6e-7


def test_a_blow_in_a_short_step_is_no_force_that_lasts() -> None:
    moving = world(cubes(6), sleeping=False, restitution=0, time_step=1e-4)
    start = lowest = moving.energy()
    while not any(touch.contacts for touch in moving.touches()):
        moving.step()
    rise = 0.0
    for number in range(16):
        moving.adjust(moving.law.model_copy(update={"time_step": 1e-4 if number % 2 else 1 / 30}))
        moving.step()
        rise, lowest = max(rise, moving.energy() - lowest), min(lowest, moving.energy())
    assert rise < 1e-2 * start  # 1e-4; with impulses in proportion to any length: 4


@pytest.mark.parametrize(("spin", "gap"), [(100.0, 0.01), (230.0, 0.012)])
def test_a_snapshot_between_divided_steps_goes_on_to_the_same_bits(spin: float, gap: float) -> None:
    stones = [*cubes(3), *twins(spin, gap)]
    moving, other = world(stones), world(stones)
    advance(moving, 0.2)
    other.restore(moving.snapshot())
    for _ in range(5):
        moving.step()
        other.step()
        assert other.state.bodies == moving.state.bodies


@pytest.mark.parametrize("gone", ["stone", "surface"])
def test_a_snapshot_between_divided_steps_holds_nothing_of_what_is_gone(gone: str) -> None:
    moving = world([*twins(100.0, 0.01), *cubes(3)], (Surface((0.0, 1.0, 0.0), -50.0), FLOOR))
    advance(moving, 0.2)
    if gone == "stone":
        moving.remove("cube-2")
    else:
        moving.surround((FLOOR,))
    other = world(moving.bodies, moving.surfaces)
    other.restore(moving.snapshot())
    moving.step()
    other.step()
    assert other.state.bodies == moving.state.bodies
