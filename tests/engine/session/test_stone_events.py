"""Events that name a stone, or all stones, and a push, which finds its stone by the line of sight."""

from __future__ import annotations

from typing import Any

import pytest

from culet.engine.session import events
from culet.engine.session.session import Session
from culet.errors import InputError
from culet.scene import Scene
from culet.stage import NOTHING, Stage
from culet_protocol.messages import LookAtStone, PatchScene, Push, ResetStone, SessionEvent, ToggleFall

LEFT, RIGHT = (-4.0, 3.0, 0.0), (4.0, 3.0, 0.0)
SCENE = Scene.read(
    {
        "stones": [{"id": "left", "position": LEFT}, {"id": "right", "position": RIGHT, "scale": 2}],
        "camera": {"position": [0, 3, 20], "target": [0, 3, 0], "fov_degrees": 53.130102354156},
    }
)
"""At 20 R the picture reaches 10 R up and down: one half of its height is 10 R."""


def session() -> Session:
    return Session("0" * 32, Stage.of(SCENE))


def after(subject: Session, *given: SessionEvent) -> Session:
    for event in given:
        events.apply(subject, event, NOTHING)
    return subject


def motions(subject: Session) -> dict[str, str]:
    """As viewers are told of them."""
    return dict(subject.condition().motions)


def moved_on(subject: Session, seconds: float = 0.3) -> dict[str, Any]:
    """Where the stones are after so much time."""
    subject.advance(100)
    subject.advance(100 + seconds / 2)
    subject.advance(100 + seconds)
    return {name: position for name, (position, _) in subject.motion.latest().poses.items()}


def test_one_stone_falls_while_the_other_stays_and_each_is_told() -> None:
    subject = after(session(), ToggleFall(stone="right"))
    assert motions(subject) == {"left": "paused", "right": "falling"}
    assert subject.condition().falling
    positions = moved_on(subject)
    assert positions["left"] == LEFT
    assert positions["right"][1] < RIGHT[1] - 0.1
    after(subject, ToggleFall(stone="right"), ToggleFall(stone="left"))
    assert motions(subject) == {"left": "falling", "right": "paused"}


def test_without_a_name_all_stones_fall_and_pause() -> None:
    subject = after(session(), ToggleFall())
    assert motions(subject) == {"left": "falling", "right": "falling"}
    positions = moved_on(subject)
    assert positions["left"][1] == pytest.approx(positions["right"][1], abs=1e-9)
    assert positions["left"][1] < LEFT[1] - 0.1
    after(subject, ToggleFall())
    assert motions(subject) == {"left": "paused", "right": "paused"}


def test_one_stone_is_put_back_while_the_other_falls_on() -> None:
    subject = after(session(), ToggleFall())
    moved_on(subject)
    after(subject, ResetStone(stone="left"))
    positions = {name: position for name, (position, _) in subject.motion.latest().poses.items()}
    assert positions["left"] == LEFT
    assert positions["right"][1] < RIGHT[1] - 0.1
    assert motions(subject) == {"left": "paused", "right": "falling"}
    after(subject, ResetStone())
    assert [position for position, _ in subject.motion.latest().poses.values()] == [LEFT, RIGHT]
    assert motions(subject) == {"left": "paused", "right": "paused"}


def test_once_each_stone_is_paused_by_itself_the_session_is_paused_and_falls_on_as_one() -> None:
    subject = after(session(), ToggleFall())
    positions = moved_on(subject)
    after(subject, ToggleFall(stone="left"), ToggleFall(stone="right"))
    assert motions(subject) == {"left": "paused", "right": "paused"}
    assert not subject.condition().falling
    after(subject, ToggleFall())
    assert motions(subject) == {"left": "falling", "right": "falling"}
    now = {name: position for name, (position, _) in subject.motion.latest().poses.items()}
    assert now == positions, "from where they were"


def test_the_last_stone_that_falls_is_put_back_and_the_session_is_paused() -> None:
    subject = after(session(), ToggleFall(stone="left"))
    moved_on(subject)
    after(subject, ResetStone(stone="left"))
    assert not subject.condition().falling
    assert after(subject, ToggleFall()).condition().motions == {"left": "falling", "right": "falling"}


def test_a_stone_that_was_paused_in_the_air_falls_on_from_there_though_no_other_moves() -> None:
    """One is held in the air, the other asleep on the floor: nothing moves, but not all have come to rest for good."""
    subject = after(session(), ToggleFall())
    moved_on(subject)
    after(subject, ToggleFall(stone="left"))
    held, _ = subject.motion.latest().poses["left"]
    now = 101.0
    while subject.motion.moving and now < 160:
        subject.advance(now)
        now += 0.2
    assert motions(subject) == {"left": "paused", "right": "asleep"}
    assert not subject.condition().asleep
    after(subject, ToggleFall())
    assert motions(subject)["left"] == "falling"
    assert subject.motion.latest().poses["left"][0] == held
    subject.advance(now)
    subject.advance(now + 0.2)
    assert subject.motion.latest().poses["left"][0][1] < held[1]


def test_a_push_moves_the_stone_that_is_seen_at_that_point_and_no_other() -> None:
    subject = after(session(), PatchScene(patch={"simulation": {"gravity": 0}}), Push(x=0.4, y=0, right=0, up=2))
    positions = moved_on(subject)
    assert positions["left"] == pytest.approx(LEFT, abs=1e-12)
    assert positions["right"][1] == pytest.approx(RIGHT[1] + 2 * 0.3, abs=0.05)
    assert after(session(), Push(x=0, y=0, right=0, up=2)).motion.falling is False, "between the two there is nothing"


def test_the_camera_looks_at_one_stone_or_at_all_of_them() -> None:
    assert after(session(), LookAtStone(stone="right")).scene.camera.target == RIGHT
    both = after(session(), LookAtStone()).scene.camera
    assert both.target == pytest.approx((0.5, 3, 0)), "the middle of -5 to 6"


@pytest.mark.parametrize("event", [LookAtStone, ToggleFall, ResetStone])
@pytest.mark.parametrize("name", ["middle", "left-2", "lef"])
def test_a_stone_that_is_not_there_is_refused_by_name_and_nothing_changes(
    event: type[LookAtStone | ToggleFall | ResetStone], name: str
) -> None:
    subject = session()
    shown, before = subject.shown, motions(subject)
    with pytest.raises(InputError, match=r"expected the id of a stone \('left', 'right'\).*got") as caught:
        after(subject, event(stone=name))
    assert caught.value.field == "stone"
    assert subject.shown is shown
    assert motions(subject) == before


@pytest.mark.parametrize("event", [LookAtStone(), ToggleFall(), LookAtStone(stone="left"), ToggleFall(stone="left")])
def test_without_any_stone_the_lack_is_said(event: SessionEvent) -> None:
    with pytest.raises(InputError, match="expected a scene with a stone, got none"):
        after(Session("0" * 32, Stage.of(Scene(stones=()))), event)


def test_stones_that_have_come_to_rest_are_told_to_sleep_and_one_that_is_dropped_falls() -> None:
    subject = after(session(), ToggleFall())
    now = 0.0
    while subject.motion.moving and now < 60:
        subject.advance(now)
        now += 0.2
    assert motions(subject) == {"left": "asleep", "right": "asleep"}
    assert subject.condition().asleep
    after(subject, ToggleFall(stone="left"))
    assert motions(subject)["left"] == "falling"
    assert not subject.condition().asleep
