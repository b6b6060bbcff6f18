"""The camera stays out of stones, along planes and triangles alike."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from culet.engine.session import viewpoint
from culet.engine.session.clearance import CLEARANCE, entered, is_inside, stepped_back, stopped
from culet.engine.session.picking import Placed, spans_inside
from culet.geometry.shape import Shape
from culet.scene import Camera, Vector
from shared.stones import box, skew_block

SIDE = 1 / math.sqrt(3)
"""R: half the edge of the cube whose corners are at 1 R."""
CUBE = box(1, 1, 1)()
OF_TRIANGLES = replace(CUBE, convex=False)
AHEAD = Camera(position=(0, 0, 5), target=(0, 0, 0), fov_degrees=45)


def at(position: Vector = (0, 0, 0), name: str = "stone", shape: Shape = CUBE, scale: float = 1.0) -> Placed:
    return Placed(name, shape, scale, position, (1.0, 0.0, 0.0, 0.0))


@pytest.fixture(params=[CUBE, OF_TRIANGLES], ids=["planes", "triangles"])
def cube(request: pytest.FixtureRequest) -> Placed:
    return at(shape=request.param)


def test_a_line_is_in_a_stone_from_where_it_enters_to_where_it_leaves(cube: Placed) -> None:
    eye, way = np.array([0.1, 0.2, 5.0]), np.array([0.0, 0.0, -1.0])
    assert spans_inside(eye, way, cube) == [pytest.approx((5 - SIDE, 5 + SIDE))]
    assert spans_inside(eye, way, cube._replace(scale=0.5)) == [pytest.approx((5 - SIDE / 2, 5 + SIDE / 2))]
    assert spans_inside(-eye, way, cube) == [pytest.approx((-5 - SIDE, -5 + SIDE))], "behind the eye"
    assert spans_inside(np.add(eye, (0.9, 0, 0)), way, cube) == []


def test_a_zoom_ends_before_the_stone_however_far_it_would_go(cube: Placed) -> None:
    for forward in (4.6, 100.0):
        camera = stopped(AHEAD, viewpoint.dolly(AHEAD, forward), [cube])
        assert camera.position == pytest.approx((0, 0, SIDE + CLEARANCE), abs=1e-12)
        assert camera.target == AHEAD.target
    again = stopped(camera, viewpoint.dolly(camera, 0.5), [cube])
    assert again.position == pytest.approx(camera.position, abs=1e-12)
    away = viewpoint.dolly(camera, -1.0)
    assert stopped(camera, away, [cube]) == away


def test_a_move_that_meets_no_stone_is_as_it_was_asked_for_to_the_bit(cube: Placed) -> None:
    for after in (viewpoint.dolly(AHEAD, 1.3), viewpoint.translate(AHEAD, 3.0, 0.2), viewpoint.dolly(AHEAD, -60)):
        assert stopped(AHEAD, after, [cube]) == after
    turned = viewpoint.orbit(AHEAD, 0.7, 0.2)
    assert stepped_back(AHEAD, turned, [cube]) == turned


def test_the_camera_backs_into_no_stone_and_slides_into_none_with_its_target(cube: Placed) -> None:
    behind, beside = cube._replace(position=(0, 0, 8)), cube._replace(position=(3, 0, 5))
    assert stopped(AHEAD, viewpoint.dolly(AHEAD, -9), [behind]).position[2] == pytest.approx(8 - SIDE - CLEARANCE)
    slid = stopped(AHEAD, viewpoint.translate(AHEAD, 4.0, 0.0), [beside])
    assert slid.position == pytest.approx((3 - SIDE - CLEARANCE, 0, 5))
    assert np.subtract(slid.target, slid.position) == pytest.approx(np.subtract(AHEAD.target, AHEAD.position))


def test_an_orbit_that_would_end_in_a_stone_goes_about_it(cube: Placed) -> None:
    close = Camera(position=(0, 0, SIDE + CLEARANCE), target=(0, 0, 0), fov_degrees=45)
    corner = stepped_back(close, viewpoint.orbit(close, math.radians(45), 0), [cube])
    assert math.hypot(*corner.position) == pytest.approx(SIDE * math.sqrt(2) + CLEARANCE)
    assert corner.position[0] == pytest.approx(corner.position[2])
    # Behind that stone is another, which touches the first one's corner; the camera goes beyond both.
    second = cube._replace(name="second", position=(2 * SIDE, 0, 2 * SIDE))
    past = stepped_back(close, viewpoint.orbit(close, math.radians(45), 0), [second, cube])
    assert math.hypot(*past.position) == pytest.approx(3 * SIDE * math.sqrt(2) + CLEARANCE)


def test_a_camera_that_is_in_a_stone_may_leave_it(cube: Placed) -> None:
    within = Camera(position=(0, 0, 0.3), target=(0, 0, -1), fov_degrees=45)
    for after in (viewpoint.dolly(within, -1), viewpoint.translate(within, 2.0, 0.0)):
        assert stopped(within, after, [cube]) == after
    turned = viewpoint.orbit(within, 0.2, 0.0)
    assert stepped_back(within, turned, [cube]) == turned


def test_parallel_rays_come_from_outside_wherever_their_camera_is(cube: Placed) -> None:
    flat = AHEAD.model_copy(update={"kind": "orthographic"})
    nearer = viewpoint.dolly(flat, 4.7)
    assert stopped(flat, nearer, [cube]) == nearer
    assert stepped_back(flat, nearer, [cube]) == nearer


def test_a_place_in_a_stone_is_told_from_one_in_its_ball_alone(cube: Placed) -> None:
    assert is_inside(np.array([0.5, 0.5, -0.5]), cube)
    assert not is_inside(np.array([0.0, 0.0, 0.6]), cube)
    assert entered((0, 0, 5), (0, 0, 0.2), [at((9, 9, 9), "other"), cube]) == "stone"
    assert entered((0, 0, 0.1), (0, 0, 0.2), [cube]) is None, "it was there before"


def test_a_hollow_that_is_open_may_be_entered() -> None:
    """Two cubes that do not touch, as one shape: between them is no stone."""
    vertices, triangles = CUBE.vertices, CUBE.triangles
    pair = replace(
        OF_TRIANGLES,
        vertices=np.vstack([vertices * 0.4 + (0.6, 0, 0), vertices * 0.4 - (0.6, 0, 0)]),
        triangles=np.vstack([triangles, triangles + len(vertices)]),
    )
    stone = at(shape=pair)
    through = viewpoint.dolly(AHEAD, 4.9)
    assert stopped(AHEAD, through, [stone]) == through
    aside = stopped(through, viewpoint.translate(through, 1.0, 0.0), [stone])
    assert aside.position[0] == pytest.approx(0.6 - 0.4 * SIDE - CLEARANCE)


def test_a_turned_stone_of_any_size_stops_the_camera_at_its_own_surface() -> None:
    turn = (math.cos(math.pi / 8), 0.0, math.sin(math.pi / 8), 0.0)  # by 45 degrees about y
    stone = Placed("stone", skew_block(), 2.0, (0, 0, 0), turn)
    camera = stopped(AHEAD, viewpoint.dolly(AHEAD, 10), [stone])
    ahead = np.array([0.0, 0.0, -1.0])
    (enter, _), *_ = spans_inside(np.array(camera.position), ahead, stone)
    assert enter == pytest.approx(CLEARANCE)
