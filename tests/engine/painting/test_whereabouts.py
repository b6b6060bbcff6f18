"""On which side of the picture a stone is said to be, against the picture's own edges."""

from __future__ import annotations

import pytest

from culet.engine.painting.whereabouts import Ball, whereabouts
from culet.scene import Camera, Scene, Vector
from culet_protocol.frame import Flags

SQUARE_ANGLE = Camera(position=(0, 0, 10), target=(0, 0, 0), fov_degrees=90)


# At a distance of 10 a picture of 90 degrees reaches up to 10, and a ball of radius 1 is out of it from 10 + sqrt 2
# (11.414) on; one twice as wide reaches to 20 at the side, and the ball is out of it from 20 + sqrt 5 (22.236) on.
@pytest.mark.parametrize(
    ("position", "where"),
    [
        ((0, 0, 0), Flags.NONE),
        ((0, 11.41, 0), Flags.NONE),
        ((0, 11.42, 0), Flags.ABOVE),
        ((0, -11.41, 0), Flags.NONE),
        ((0, -11.42, 0), Flags.BELOW),
        ((22.23, 0, 0), Flags.NONE),
        ((22.24, 0, 0), Flags.RIGHT),
        ((-22.23, 0, 0), Flags.NONE),
        ((-22.24, 0, 0), Flags.LEFT),
        ((30, -20, 0), Flags.RIGHT | Flags.BELOW),
        ((0, 0, 10.9), Flags.NONE),
        ((0, 0, 11.1), Flags.BEHIND),
        ((50, 0, 10.9), Flags.RIGHT),
        ((50, 50, 11.1), Flags.BEHIND),
        ((0, 0, -1e5), Flags.NONE),
    ],
)
def test_a_stone_is_out_of_the_picture_once_its_ball_is(position: Vector, where: Flags) -> None:
    assert whereabouts(SQUARE_ANGLE, [Ball(position)], 2) == where


def test_it_is_seen_less_far_at_the_side_of_an_upright_picture() -> None:
    assert whereabouts(SQUARE_ANGLE, [Ball((8, 0, 0))], 0.5) == Flags.RIGHT
    assert whereabouts(SQUARE_ANGLE, [Ball((8, 0, 0))], 1) == Flags.NONE


def test_sides_are_those_of_the_picture_and_not_of_the_world() -> None:
    upside_down = SQUARE_ANGLE.model_copy(update={"up": (0, -1, 0)})
    assert whereabouts(upside_down, [Ball((0, 12, 0))], 1) == Flags.BELOW
    assert whereabouts(upside_down, [Ball((12, 0, 0))], 1) == Flags.LEFT


def test_the_default_stone_is_in_the_default_picture_until_it_is_put_at_the_end_of_the_page_s_slider() -> None:
    scene = Scene()
    assert whereabouts(scene.camera, [Ball(scene.stones[0].position)], 1.6) == Flags.NONE
    assert whereabouts(scene.camera, [Ball((0, 8, 0))], 1.6) == Flags.ABOVE


def test_of_several_stones_none_is_missed_while_one_may_be_seen() -> None:
    assert whereabouts(SQUARE_ANGLE, [Ball((0, 30, 0)), Ball((0, 0, 0)), Ball((-50, 0, 0))], 1) == Flags.NONE


def test_of_several_stones_out_of_the_picture_the_nearest_is_told() -> None:
    above, left, behind = Ball((0, 30, 0)), Ball((-50, 0, 0)), Ball((0, 0, 70))
    assert whereabouts(SQUARE_ANGLE, [left, above, behind], 1) == Flags.ABOVE
    assert whereabouts(SQUARE_ANGLE, [left, behind], 1) == Flags.LEFT
    assert whereabouts(SQUARE_ANGLE, [behind], 1) == Flags.BEHIND
    large = Ball((-70, 0, 0), 40)
    assert whereabouts(SQUARE_ANGLE, [above, large], 1) == Flags.ABOVE, "30.6 R from the camera, the other 30.7"
    assert whereabouts(SQUARE_ANGLE, [behind, large], 1) == Flags.LEFT, "though the one behind has the nearer centre"
    assert whereabouts(SQUARE_ANGLE, [], 1) == Flags.NONE


def test_a_larger_stone_is_seen_from_farther_out_of_the_picture() -> None:
    """Out of it from 10 + 3 sqrt 2 (14.243) on."""
    assert whereabouts(SQUARE_ANGLE, [Ball((0, 14.24, 0), 3)], 1) == Flags.NONE
    assert whereabouts(SQUARE_ANGLE, [Ball((0, 14.25, 0), 3)], 1) == Flags.ABOVE
    assert whereabouts(SQUARE_ANGLE, [Ball((0, 0, 12.9), 3)], 1) == Flags.NONE
    assert whereabouts(SQUARE_ANGLE, [Ball((0, 0, 13.1), 3)], 1) == Flags.BEHIND
