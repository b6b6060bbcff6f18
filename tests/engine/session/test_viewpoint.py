import math

import numpy as np
import pytest

from culet.engine.session import viewpoint
from culet.scene import Camera

CAMERA = Camera(position=(0, 0, 5), target=(0, 0, 0), fov_degrees=45)
OBLIQUE = Camera(position=(1, 2.5, 4), target=(0.5, 0.25, -0.5), up=(0.1, 1, 0.2), fov_degrees=45)


def distance(camera: Camera) -> float:
    return math.dist(camera.position, camera.target)


def test_a_quarter_turn_to_the_right_is_seen_from_the_right() -> None:
    # counter-clockwise seen from above takes +z to +x
    turned = viewpoint.orbit(CAMERA, math.pi / 2, 0)
    assert turned.position == pytest.approx((5, 0, 0), abs=1e-15)  # measured 3e-16


def test_an_orbit_up_by_30_degrees_rises_by_half_the_distance() -> None:
    raised = viewpoint.orbit(CAMERA, 0, math.radians(30))
    assert raised.position == pytest.approx((0, 2.5, 5 * math.cos(math.radians(30))), abs=1e-14)


def test_an_orbit_keeps_distance_and_target() -> None:
    turned = viewpoint.orbit(OBLIQUE, 0.7, -0.3)
    assert turned.target == OBLIQUE.target
    assert distance(turned) == pytest.approx(distance(OBLIQUE), rel=1e-14)


def test_a_full_turn_comes_back() -> None:
    camera = OBLIQUE
    for _ in range(360):
        camera = viewpoint.orbit(camera, math.radians(1), 0)
    assert camera.position == pytest.approx(OBLIQUE.position, abs=1e-12)  # measured 7e-14


@pytest.mark.parametrize("pitch", [10.0, -10.0])
def test_an_orbit_stops_short_of_the_pole(pitch: float) -> None:
    top = viewpoint.orbit(CAMERA, 0, pitch)
    elevation = math.asin(top.position[1] / 5)
    assert elevation == pytest.approx(math.copysign(viewpoint.STEEPEST, pitch), abs=1e-9)
    again = viewpoint.orbit(top, 0, pitch)
    assert again.position == pytest.approx(top.position, abs=1e-9)


def test_a_view_steeper_than_the_limit_stays_and_can_be_left() -> None:
    steep = Camera(position=(0, 5, 5 * math.tan(math.radians(0.5))), target=(0, 0, 0), fov_degrees=45)
    assert viewpoint.orbit(steep, 0, 0.1).position == pytest.approx(steep.position, abs=1e-9)
    assert viewpoint.orbit(steep, 0, -0.5).position[1] < 4.5


def test_a_camera_that_looks_at_a_point_has_turned_no_way_and_is_as_far_from_it() -> None:
    moved = viewpoint.look_at(OBLIQUE, (30.0, -1.0, 7.0))
    assert moved.target == pytest.approx((30.0, -1.0, 7.0), abs=0)
    assert np.subtract(moved.position, moved.target) == pytest.approx(np.subtract(OBLIQUE.position, OBLIQUE.target))
    assert (moved.up, moved.fov_degrees) == (OBLIQUE.up, OBLIQUE.fov_degrees)


def test_a_camera_too_near_for_a_whole_stone_steps_back_to_where_its_ball_touches_the_edges() -> None:
    # A ball of radius 1 fills 60 degrees from 1 / sin 30 degrees.
    near = Camera(position=(0, 0, 0.5), target=(0, 0, 0), fov_degrees=60)
    assert viewpoint.look_at(near, (1, 2, 3)).position == pytest.approx((1, 2, 5), abs=1e-14)  # measured 9e-16


def test_a_camera_too_near_for_a_larger_stone_steps_back_farther() -> None:
    near = Camera(position=(0, 0, 0.5), target=(0, 0, 0), fov_degrees=60)
    assert viewpoint.look_at(near, (1, 2, 3), 2.5).position == pytest.approx((1, 2, 8), abs=1e-14)
    flat = near.model_copy(update={"kind": "orthographic", "height": 3.0})
    assert viewpoint.look_at(flat, (1, 2, 3), 2.5).height == 5


def test_the_ball_about_balls_holds_them_all_and_that_about_one_is_that_one() -> None:
    assert viewpoint.ball_about([((1, 2, 3), 0.5)]) == ((1, 2, 3), 0.5)
    balls = [((0.0, 0.0, 0.0), 1.0), ((6.0, 0.0, 0.0), 2.0), ((0.0, 5.0, -1.0), 0.3)]
    centre, radius = viewpoint.ball_about(balls)
    assert max(math.dist(centre, middle) + own for middle, own in balls) == pytest.approx(radius, rel=1e-12)
    assert viewpoint.ball_about(balls[:2]) == ((3.5, 0, 0), 4.5), "touches both"


def test_translation_moves_camera_and_target_alike_across_the_line_of_sight() -> None:
    moved = viewpoint.translate(OBLIQUE, 2, -1)
    shift = np.subtract(moved.position, OBLIQUE.position)
    assert shift == pytest.approx(np.subtract(moved.target, OBLIQUE.target))
    assert np.linalg.norm(shift) == pytest.approx(math.sqrt(5))
    assert shift @ np.subtract(OBLIQUE.target, OBLIQUE.position) == pytest.approx(0, abs=1e-12)


def test_right_is_plus_x_for_a_camera_that_looks_along_minus_z() -> None:
    assert viewpoint.translate(CAMERA, 1, 0).position == pytest.approx((1, 0, 5))
    assert viewpoint.translate(CAMERA, 0, 1).position == pytest.approx((0, 1, 5))


def test_a_dolly_goes_along_the_line_of_sight() -> None:
    assert viewpoint.dolly(CAMERA, 2).position == pytest.approx((0, 0, 3))
    assert viewpoint.dolly(CAMERA, -2).position == pytest.approx((0, 0, 7))


def test_a_dolly_never_passes_through_the_target() -> None:
    near = viewpoint.dolly(CAMERA, 1000)
    assert near.position == pytest.approx((0, 0, viewpoint.CLOSEST))
    assert viewpoint.dolly(near, 1).position == pytest.approx(near.position)
    assert viewpoint.dolly(near, -1).position == pytest.approx((0, 0, 1 + viewpoint.CLOSEST))


def test_a_light_orbits_about_the_origin() -> None:
    assert viewpoint.orbit_light((0, 0, 4), math.pi / 2, 0) == pytest.approx((4, 0, 0), abs=1e-15)
    assert math.hypot(*viewpoint.orbit_light((-4, 6, 4), 0.3, 0.2)) == pytest.approx(math.sqrt(68))


def test_a_light_above_the_pole_or_at_the_origin_can_be_turned() -> None:
    assert math.hypot(*viewpoint.orbit_light((0, 3, 0), 1, -0.5)) == pytest.approx(3)
    assert viewpoint.orbit_light((0, 0, 0), 1, 1) == (0, 0, 0)


def test_a_light_moves_along_the_cameras_axes() -> None:
    assert viewpoint.shift_light((1, 1, 1), CAMERA, 1, 2, 3) == pytest.approx((2, 3, -2))
