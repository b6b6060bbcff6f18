"""A stone that stands on the floor is lifted before it falls, by the key and by the command alike."""

from __future__ import annotations

from culet.engine.session.session import Session
from culet.geometry.shape import Shape
from culet.scene import Scene
from culet.simulation.one_stone.drop import DROP_HEIGHT
from culet.simulation.staged import dropped
from shared.stages import staged


def test_a_stone_that_starts_at_rest_falls_when_it_is_let_fall(brilliant: Shape) -> None:
    session = Session("0" * 32, staged(Scene(), brilliant))
    session.toggle_fall()
    session.advance(0)
    session.advance(0.2)
    pose = session.pose()
    assert pose is not None
    assert 1.2 < pose["position"][1] < DROP_HEIGHT  # 9.81 x 0.2^2 / 2 = 0.196 below, less a step
    session.toggle_fall()
    session.toggle_fall()
    assert session.pose() == pose, "a pause lifts nothing"
    session.reset_stone()
    pose = session.pose()
    assert pose is not None
    assert pose["position"] == Scene().stones[0].position


def test_a_stone_in_the_air_falls_from_where_it_is(brilliant: Shape) -> None:
    for height in (0.5, 4.0):
        scene = Scene().moved(((0.5, height, 0.25), Scene().stones[0].orientation))
        assert dropped(staged(scene, brilliant)).scene == scene
    assert dropped(staged(Scene(), brilliant)).scene.stones[0].position == (0, DROP_HEIGHT, 0)
