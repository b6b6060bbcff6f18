"""A push with the pointer: where it strikes, and what a session does then."""

from __future__ import annotations

import math

import pytest

from culet.engine.session.session import Session
from culet.errors import InputError
from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT
from culet.stage import Stage

SCENE = LEGACY_DEFAULT


def test_a_push_moves_a_paused_stone_by_that_speed_and_lets_time_go_on() -> None:
    session = Session("0" * 32, Stage.of(SCENE))
    session.push(0, 0, 0.5, 0)  # the camera looks at the stone, and its right is +x
    assert session.motion.moving
    session.advance(100.0)
    session.advance(100.1)
    pose = session.pose()
    assert pose is not None
    fallen = 0.1 - SCENE.simulation.time_step  # drawn one step behind
    assert pose["position"][0] == pytest.approx(0.5 * fallen, rel=0.01)
    assert math.dist(pose["orientation"], SCENE.stones[0].orientation) > 1e-3


def test_a_push_wakes_a_stone_that_rests_without_a_jump_in_time() -> None:
    session = Session("0" * 32, Stage.of(SCENE))
    session.set_falling(True)
    now = 0.0
    while session.motion.moving and now < 60:
        session.advance(now)
        now += 0.2
    assert not session.motion.moving
    time = session.shown.simulation_time
    session.push(0, -0.2, 1, 1)
    assert session.shown.moving
    session.advance(now + 1000)
    assert session.shown.simulation_time == pytest.approx(time, abs=0.01)


def test_a_push_past_the_stone_changes_nothing() -> None:
    session = Session("0" * 32, Stage.of(SCENE))
    before = session.shown
    session.push(5, 5, 1, 1)
    assert session.shown == before
    assert not session.motion.moving


def test_nothing_can_be_pushed_in_a_scene_without_a_stone() -> None:
    with pytest.raises(InputError, match="nothing can be pushed"):
        Session("0" * 32, Stage.of(Scene(stones=()))).push(0, 0, 1, 0)
