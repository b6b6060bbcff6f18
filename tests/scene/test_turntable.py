"""A scene from all around."""

from __future__ import annotations

import math

import pytest

from culet.scene import PRESETS, Scene
from culet.scene.turntable import around


def test_the_first_view_is_the_scene_itself() -> None:
    scene = Scene()
    assert next(around(scene, 5)) == scene


def test_a_quarter_of_a_turn_goes_counter_clockwise_seen_from_above() -> None:
    """y is up: from +z the camera comes to +x, then to -z; as far from its target, at its height."""
    before, quarter, half, _ = (view.camera for view in around(Scene(), 4))
    x, y, z = (a - b for a, b in zip(before.position, before.target, strict=True))
    for camera, expected in ((quarter, (z, y, -x)), (half, (-x, y, -z))):
        offset = [a - b for a, b in zip(camera.position, camera.target, strict=True)]
        assert offset == pytest.approx(expected, rel=1e-12, abs=1e-12)  # measured 2e-15
        assert (camera.target, camera.up) == (before.target, before.up)


def test_a_camera_that_looks_straight_down_turns_the_picture() -> None:
    before, quarter, *_ = (view.camera for view in around(PRESETS["face-up"].scene, 4))
    assert quarter.position == before.position
    assert before.up == pytest.approx((0, 0, -1))
    assert quarter.up == pytest.approx((-1, 0, 0), abs=1e-15)


def test_a_leaning_camera_leans_as_much_all_around() -> None:
    scene = Scene.read({"camera": {"position": [3, 1, 2], "target": [0, 0, 0], "up": [1, 2, 0]}})
    for camera in (view.camera for view in around(scene, 7)):
        assert math.hypot(*camera.position) == pytest.approx(math.sqrt(14), rel=1e-12)
        assert sum(a * b for a, b in zip(camera.position, camera.up, strict=True)) == pytest.approx(5, rel=1e-12)
