"""What follows from light and room is found once for stones that move, and anew for any other light or room."""

from __future__ import annotations

import itertools
import weakref

import numpy as np

from culet.rendering.emitters.of_room import of_room
from culet.scene import Scene
from culet.stage import Stage

MATTE = Scene.read({"floor": {"kind": "matte"}})


def test_stones_that_move_ask_for_nothing_again() -> None:
    asked = itertools.count(1)
    found = of_room(lambda _: next(asked))
    moved = MATTE.moved(((0.0, 5.0, 0.0), (1.0, 0.0, 0.0, 0.0)))
    other = MATTE.model_copy(update={"emitters": MATTE.emitters[:1]})  # of a session that moves at the same time
    assert [found(Stage.of(scene)) for scene in (MATTE, other, moved, other, MATTE)] == [1, 2, 1, 2, 1]


def test_another_light_or_room_does() -> None:
    found = of_room(lambda stage: (stage.scene.emitters, stage.scene.environment, stage.scene.floor, stage.scene.walls))
    for change in (
        {"emitters": MATTE.emitters[:1]},
        {"environment": Scene.read({"environment": {"kind": "dark"}}).environment},
        {"floor": Scene.read({"floor": {"kind": "mirror"}}).floor},
        {"walls": Scene.read({"walls": {"kind": "matte"}}).walls},
    ):
        scene = MATTE.model_copy(update=change)
        assert found(Stage.of(MATTE)) == (MATTE.emitters, MATTE.environment, MATTE.floor, MATTE.walls)
        assert found(Stage.of(scene)) == (scene.emitters, scene.environment, scene.floor, scene.walls)


def test_a_sky_that_is_gone_is_none_that_is_missing() -> None:
    found = of_room(lambda stage: stage.panorama is None)
    sky = np.ones((2, 4, 3), np.float32)
    assert found(Stage(MATTE, (), sky)) is False
    kept = weakref.ref(sky)
    del sky
    assert kept() is None, "what was found keeps no sky"
    assert found(Stage(MATTE, (), None)) is True
