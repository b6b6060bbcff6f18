"""A stone that a hand moves ends where there is room, and pushes nothing else."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from culet.errors import InputError
from culet.scene.room import FLOOR_Y
from culet.simulation.bodies import Body
from culet.simulation.lying import resting_height
from culet.simulation.placing import OVERLAP, moved_by_hand
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS, Surface
from culet.simulation.together import Together
from culet.simulation.world import World
from shared.stones import box, brilliant, ring

CUBE, STONE = box(1, 1, 1)(), brilliant()
SIDE = 1 / math.sqrt(3)
"""R: half the edge of the cube."""
UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
STILL: Triple = (0.0, 0.0, 0.0)
ON_THE_FLOOR = FLOOR_Y + SIDE


def cube(name: str, *position: float, scale: float = 1.0) -> Body:
    x, y, z = position
    return Body(name, CUBE, (x, y, z), UPRIGHT, scale=scale)


def world(*bodies: Body, surfaces: Sequence[Surface] = (FLOOR,)) -> World:
    return World(bodies, surfaces)


def put(where: World, name: str, shift: Triple, turn: Triple = STILL) -> World:
    pose = moved_by_hand(where, name, shift, turn)
    assert pose is not None
    where.move(name, *pose)
    return where


def place(where: World, name: str) -> Triple:
    return where.state.bodies[where.number(name)].position


def test_a_move_through_empty_space_is_made_to_the_bit() -> None:
    assert place(put(world(cube("one", 0.1, 2.3, 0.7)), "one", (1.0, 2.0, -3.0)), "one") == (0.1 + 1, 2.3 + 2, 0.7 - 3)


@pytest.mark.parametrize("others", [(), (cube("far", 9, 0, 9),)], ids=["alone", "one of two"])
def test_what_is_pressed_into_the_floor_slides_along_it(others: tuple[Body, ...]) -> None:
    moved = put(world(cube("one", 0, ON_THE_FLOOR, 0), *others), "one", (0.4, -0.3, 0.2))
    assert place(moved, "one") == pytest.approx((0.4, ON_THE_FLOOR, 0.2), abs=1e-12)


def test_a_stone_comes_to_lie_against_another_which_stays() -> None:
    moved = put(world(cube("one", 0, 0, 0), cube("two", 2, 0, 0)), "one", (1.3, 0.0, 0.0))
    assert place(moved, "one") == pytest.approx((2 - 2 * SIDE, 0, 0), abs=OVERLAP)
    assert place(moved, "two") == (2, 0, 0)
    assert moved.separation("one", "two") == pytest.approx(0, abs=OVERLAP)


def test_a_stone_that_is_pressed_on_another_on_the_floor_is_lifted_onto_it_or_beside_it() -> None:
    moved = put(world(cube("one", 2, ON_THE_FLOOR, 0), cube("two", 0, ON_THE_FLOOR, 0)), "one", (-2.0, 0.9, 0.0))
    assert place(moved, "one") == pytest.approx((0, ON_THE_FLOOR + 2 * SIDE, 0), abs=OVERLAP)


def test_in_a_corner_of_floor_and_walls_a_stone_is_in_none_of_them() -> None:
    surfaces = (FLOOR, *WALLS)
    moved = put(world(Body("one", STONE, (0, 0, 0), UPRIGHT), surfaces=surfaces), "one", (0.0, -3.0, -20.0))
    corners = STONE.vertices + np.array(place(moved, "one"))
    for normal, offset in surfaces:
        assert (corners @ np.array(normal)).min() >= offset - OVERLAP


def test_a_stone_that_is_held_on_all_sides_stays() -> None:
    lid = Surface((0.0, -1.0, 0.0), -(ON_THE_FLOOR + SIDE))
    sides = [Surface((0.0, 0.0, sign), -SIDE) for sign in (1.0, -1.0)]
    ends = [Surface((sign, 0.0, 0.0), -3 * SIDE) for sign in (1.0, -1.0)]
    cubes = [cube(name, x, ON_THE_FLOOR, 0) for name, x in (("one", 0.0), ("left", -2 * SIDE), ("right", 2 * SIDE))]
    held = put(world(*cubes, surfaces=(FLOOR, lid, *sides, *ends)), "one", (0.5 * SIDE, 0.2, 0.1))
    assert place(held, "one") == pytest.approx((0, ON_THE_FLOOR, 0), abs=OVERLAP)


def test_a_stone_that_fits_nowhere_is_not_moved() -> None:
    narrow = [Surface((sign, 0.0, 0.0), -0.9 * SIDE) for sign in (1.0, -1.0)]
    assert moved_by_hand(world(cube("one", 0, 0, 0), surfaces=narrow), "one", (0.0, 1.0, 0.0), STILL) is None


def test_a_stone_on_the_floor_that_is_turned_stands_on_the_floor() -> None:
    height = resting_height(STONE, UPRIGHT)
    turned = put(world(Body("one", STONE, (3, height, 0), UPRIGHT)), "one", STILL, (0.5, 0.0, 0.3))
    position, orientation = turned.state.bodies[0].position, turned.state.bodies[0].orientation
    assert position == pytest.approx((3, resting_height(STONE, orientation), 0))
    angle = 2 * math.acos(orientation[0])
    assert angle == pytest.approx(math.hypot(0.5, 0.3))
    assert np.array(orientation[1:]) / math.sin(angle / 2) == pytest.approx(
        np.array([0.5, 0, 0.3]) / math.hypot(0.5, 0.3)
    )


def test_a_turn_in_the_air_keeps_the_place() -> None:
    assert place(put(world(cube("one", 0, 3, 0)), "one", STILL, (0.0, 1.0, 0.0)), "one") == (0, 3, 0)


def test_a_ring_is_as_large_as_its_hull_and_other_scales_count() -> None:
    bodies = (Body("ring", ring(), (0, 0, 0), UPRIGHT), cube("small", 0, 3, 0, scale=0.2))
    moved = put(world(*bodies, surfaces=()), "small", (0.0, -2.5, 0.0))
    assert moved.separation("ring", "small") == pytest.approx(0, abs=OVERLAP)
    assert math.hypot(*place(moved, "small")) > 0.2 * SIDE


def test_a_stone_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match="'nobody'"):
        moved_by_hand(world(cube("one", 0, 0, 0)), "nobody", (1.0, 0.0, 0.0), STILL)


def test_a_move_for_which_there_is_no_room_is_given_up_soon_among_many_stones(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stones side by side in layers, pressed together: each comparison of two takes some 12 us, and a drag moves the
    stone with every frame."""
    stones = [
        cube(f"{x}{y}{z}", 1.99 * SIDE * x, ON_THE_FLOOR + 1.99 * SIDE * y, 1.99 * SIDE * z)
        for x in range(4)
        for y in range(4)
        for z in range(4)
    ]
    compared, separation = [], Together.separation

    def counted(self: Together, one: str, other: str, margin: float) -> tuple[float, Triple]:
        compared.append(one)
        return separation(self, one, other, margin)

    monkeypatch.setattr(Together, "separation", counted)
    assert moved_by_hand(world(*stones), "111", (0.2, 0.1, 0.1), STILL) is None
    assert 0 < len(compared) < 10_000  # measured 7,978; 102,378 with a push for each stone
