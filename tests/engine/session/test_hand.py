"""Stones that a viewer moves and turns: where the camera has it, out of everything, and as edits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from culet.engine.session import events
from culet.engine.session.edits import Edits
from culet.engine.session.session import Session
from culet.errors import InputError
from culet.scene import Scene
from culet.scene.room import FLOOR_Y
from culet.simulation.overlaps import overlaps
from culet.simulation.rigid_body.rotation import rotate, rotate_back
from culet.stage import NOTHING, Stage
from culet_protocol.messages import DragStone, MoveStone, PatchScene, Redo, SessionEvent, ToggleFall, TurnStone, Undo

CAMERA = {"position": [0, 3, 20], "target": [0, 3, 0], "fov_degrees": 53.130102354156}
"""At 20 R the picture reaches 10 R up and down: one half of its height is 10 R."""
LEFT, RIGHT = (-4.0, 3.0, 0.0), (4.0, 3.0, 0.0)
PAIR = [{"id": "left", "position": LEFT}, {"id": "right", "position": RIGHT}]


def session(stones: list[dict[str, Any]] = PAIR, **scene: Any) -> Session:  # noqa: ANN401
    """Whose edits follow each other at once, however busy the machine is."""
    stage = Stage.of(Scene.read({"stones": stones, "camera": CAMERA} | scene))
    made = Session("0" * 32, stage)
    made.edits = Edits(lambda: 0.0)
    return made


def after(subject: Session, *given: SessionEvent) -> Session:
    for event in given:
        events.apply(subject, event, NOTHING)
    return subject


def shown(subject: Session, name: str = "left") -> tuple[float, float, float]:
    return next(stone.position for stone in subject.shown.scene.stones if stone.id == name)


def motions(subject: Session) -> dict[str, str]:
    return dict(subject.condition().motions)


def moved_on(subject: Session, seconds: float) -> Session:
    for step in range(1 + math.ceil(seconds / 0.2)):
        subject.advance(100 + 0.2 * step)
    return subject


def test_a_stone_moves_along_the_cameras_axes_and_starts_from_there() -> None:
    subject = after(session(), MoveStone(stone="left", right=1, up=2, forward=3))
    assert shown(subject) == pytest.approx((-3, 5, -3))
    assert subject.scene.stones[0].position == shown(subject)
    assert shown(subject, "right") == RIGHT


def test_a_drag_by_a_half_of_the_picture_moves_a_stone_by_what_that_shows_where_the_stone_is() -> None:
    subject = after(session(), DragStone(stone="left", right=0.1, up=0.2))
    assert shown(subject) == pytest.approx((-3, 5, 0))
    near = session([{"id": "left", "position": [0, 3, 10]}])
    assert shown(after(near, DragStone(stone="left", right=0.1, up=0.2))) == pytest.approx((0.5, 4, 10))
    behind = session([{"id": "left", "position": [0, 3, 30]}])
    assert shown(after(behind, DragStone(stone="left", right=0.1, up=0.2))) == (0, 3, 30), (
        "the picture shows nothing of it"
    )
    flat = session(camera={"kind": "orthographic", "position": [0, 3, 20], "target": [0, 3, 0], "height": 12})
    assert shown(after(flat, DragStone(stone="left", right=0.5, up=0))) == pytest.approx((-1, 3, 0))


@pytest.mark.parametrize(
    ("turn", "of", "to"),
    [
        (TurnStone(stone="left", yaw=math.pi / 2), (0, 0, 1), (1, 0, 0)),  # counter-clockwise from above
        (TurnStone(stone="left", pitch=math.pi / 2), (0, 0, 1), (0, 1, 0)),  # the side towards the viewer goes up
        (TurnStone(stone="left", roll=math.pi / 2), (1, 0, 0), (0, 1, 0)),  # counter-clockwise in the picture
    ],
)
def test_a_turn_is_about_the_cameras_axes(turn: TurnStone, of: Any, to: Any) -> None:  # noqa: ANN401
    subject = session()
    before = subject.scene.stones[0].orientation
    turned = after(subject, turn).shown.scene.stones[0].orientation
    assert rotate(turned, rotate_back(before, of)) == pytest.approx(to, abs=1e-12)
    assert shown(subject) == LEFT


def test_no_stone_is_put_into_the_floor_or_another_stone() -> None:
    subject = after(session(), MoveStone(stone="left", right=7.5), MoveStone(stone="right", up=-30))
    assert overlaps(subject.motion.world) == []
    assert shown(subject)[0] > 1.5, "it went as far as there was room, over or past the other"
    for name in ("left", "right"):
        stone = next(stone for stone in subject.shown.scene.stones if stone.id == name)
        assert stone.position[1] > FLOOR_Y
    before = shown(subject, "right")
    assert shown(after(subject, MoveStone(stone="right", up=-1)), "right") == pytest.approx(before, abs=1e-9)


def test_a_stone_that_fell_is_moved_from_where_it_is_while_the_other_falls_on() -> None:
    subject = moved_on(after(session(), ToggleFall()), 0.2)
    x, y, z = (state := subject.motion.states()["left"]).position
    assert y < 3 - 0.1
    after(subject, MoveStone(stone="left", right=1, up=1))
    assert shown(subject) == pytest.approx((x + 1, y + 1, z))
    assert motions(subject) == {"left": "paused", "right": "falling"}
    assert state.velocity != (0, 0, 0)
    assert subject.motion.states()["left"].velocity == (0, 0, 0)
    moved_on(subject, 0.2)
    assert shown(subject) == pytest.approx((x + 1, y + 1, z))
    after(subject, ToggleFall(stone="left"))
    assert motions(subject) == {"left": "falling", "right": "falling"}


def test_one_stone_alone_rests_where_it_is_put_until_it_is_let_fall() -> None:
    subject = moved_on(after(session([PAIR[0]]), ToggleFall()), 0.2)
    after(subject, MoveStone(stone="left", up=1))
    there = shown(subject)
    assert motions(subject) == {"left": "paused"}
    assert moved_on(subject, 0.2).shown.scene.stones[0].position == there
    after(subject, ToggleFall())
    assert moved_on(subject, 0.4).shown.scene.stones[0].position[1] < there[1] - 0.1


def test_a_resting_stone_slides_on_the_floor_and_still_lies_on_its_facet() -> None:
    """The default one, by a view from above: down in the picture is down into the floor too."""
    subject = Session("0" * 32, Stage.of(Scene()))
    (stone,) = subject.scene.stones
    after(subject, MoveStone(stone=stone.id, right=0.5, up=-0.5))
    (moved,) = subject.shown.scene.stones
    assert moved.orientation == stone.orientation
    assert moved.position[1] == pytest.approx(stone.position[1], abs=1e-4)
    assert math.dist(moved.position, stone.position) > 0.5


def test_a_drag_is_one_edit_and_is_undone_and_made_again() -> None:
    subject = session()
    drag = [DragStone(stone="left", right=0.01, up=0.02) for _ in range(10)]
    there = shown(after(subject, *drag, TurnStone(stone="left", yaw=0.1)))
    turned = subject.scene.stones[0].orientation
    before = session().scene.stones[0]
    after(subject, Undo())
    assert (shown(subject), subject.scene.stones[0].orientation) == (LEFT, before.orientation)
    assert not subject.edits.can_undo
    after(subject, Redo())
    assert (shown(subject), subject.scene.stones[0].orientation) == (there, turned)
    after(subject, MoveStone(stone="left", up=1), MoveStone(stone="right", up=1), Undo())
    assert shown(subject, "right") == RIGHT
    assert shown(subject) == pytest.approx(np.add(there, (0, 1, 0))), "moves of two stones are two edits"


def test_an_undone_move_lets_a_stone_fall_on_as_it_did() -> None:
    subject = moved_on(after(session(), ToggleFall()), 0.2)
    state = subject.motion.states()["left"]
    after(subject, MoveStone(stone="left", right=1), Undo())
    assert subject.motion.states()["left"] == state
    assert motions(subject) == {"left": "falling", "right": "falling"}


def test_a_move_of_no_stone_or_out_of_the_world_is_refused_and_changes_nothing() -> None:
    subject = session([{"id": "left", "position": [9.999e8, 3, 0]}])
    before = subject.scene
    with pytest.raises(InputError, match="'nobody'"):
        after(subject, MoveStone(stone="nobody", up=1))
    with pytest.raises(InputError, match="out of the world"):
        after(subject, MoveStone(stone="left", right=1e6))
    assert subject.scene == before
    after(subject, PatchScene(patch={"stones": []}))
    with pytest.raises(InputError, match="none"):
        after(subject, MoveStone(stone="left", up=1))
