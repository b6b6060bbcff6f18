"""A stone that was removed and is added again comes back as it was: its pose, its motion, its sleep."""

from __future__ import annotations

from typing import Any

import pytest

from culet.engine.session import events
from culet.engine.session.removals import REMEMBERED, Removals
from culet.engine.session.session import Session
from culet.scene import Scene
from culet.simulation.bodies import BodyState
from culet.stage import NOTHING, Stage
from culet_protocol.messages import PatchScene, ResetStone, SetScene, ToggleFall

SCENE: dict[str, Any] = {
    "stones": [
        {"id": "ruby", "material": "ruby", "position": [0, 3, 0], "spin": [0, 4, 1]},
        {"id": "glass", "material": "bk7", "position": [4, 3, 0]},
    ]
}
STATE = BodyState((3, 0.5, 0), (1, 0, 0, 0), (1, 2, 3), (4, 5, 6))


def session(scene: dict[str, Any] = SCENE) -> Session:
    return Session("0" * 32, Stage.of(Scene.read(scene)))


def patch(subject: Session, stones: dict[str, Any] | list[Any]) -> None:
    events.apply(subject, PatchScene(patch={"stones": stones}), NOTHING)


def settings(subject: Session, name: str) -> dict[str, Any]:
    """As a page remembers a stone."""
    (stone,) = (stone for stone in subject.scene.stones if stone.id == name)
    return stone.model_dump(mode="json")


def assert_alike(after: BodyState, before: BodyState) -> None:
    """But for the spin's last bits, since a solver keeps the angular momentum; measured 3e-15 rad/s."""
    assert (after.position, after.orientation) == (before.position, before.orientation)
    assert (after.velocity, after.asleep, after.held) == (before.velocity, before.asleep, before.held)
    assert after.spin == pytest.approx(before.spin, abs=1e-12)


def fallen(subject: Session, seconds: float = 0.4) -> Session:
    subject.set_falling(True)
    subject.advance(100)
    subject.advance(100 + seconds / 2)
    subject.advance(100 + seconds)
    return subject


def test_a_stone_in_the_air_comes_back_where_and_as_fast_as_it_was_while_the_others_have_gone_on() -> None:
    subject = fallen(session())
    before, ruby = subject.motion.states(), settings(subject, "ruby")
    patch(subject, {"ruby": None})
    assert list(subject.motion.states()) == ["glass"]
    subject.advance(100.6)
    patch(subject, {"ruby": ruby})
    after = subject.motion.states()
    assert_alike(after["ruby"], before["ruby"])
    assert before["ruby"].position[1] < 2.5, "it had fallen half a unit and more"
    assert after["glass"].position[1] < before["glass"].position[1]
    assert settings(subject, "ruby") == ruby
    subject.advance(100.8)
    assert subject.motion.states()["ruby"].position[1] < after["ruby"].position[1], "it falls on"


def test_the_only_stone_comes_back_falling_if_it_fell_and_paused_if_it_was() -> None:
    for falls in (True, False):
        subject = fallen(session({"stones": SCENE["stones"][:1]}))
        subject.set_falling(falls)
        before, ruby = subject.motion.states(), settings(subject, "ruby")
        patch(subject, {"ruby": None})
        assert subject.shown.scene.stones == ()
        assert not subject.motion.falling
        patch(subject, {"ruby": ruby})
        assert_alike(subject.motion.states()["ruby"], before["ruby"])
        assert subject.motion.falling is falls


def test_a_stone_that_slept_comes_back_asleep() -> None:
    subject = session({"stones": SCENE["stones"][:1]})
    subject.set_falling(True)
    now = 0.0
    while subject.motion.moving and now < 60:
        subject.advance(now)
        now += 0.2
    assert subject.motion.asleep
    pose, ruby = subject.pose(), settings(subject, "ruby")
    patch(subject, {"ruby": None})
    patch(subject, {"ruby": ruby})
    assert subject.pose() == pose
    assert subject.motion.motions() == {"ruby": "asleep"}


def test_a_reset_afterwards_puts_it_to_its_start() -> None:
    subject = fallen(session())
    ruby = settings(subject, "ruby")
    patch(subject, {"ruby": None})
    patch(subject, {"ruby": ruby})
    events.apply(subject, ResetStone(), NOTHING)
    position, _ = subject.motion.latest().poses["ruby"]
    assert position == (0, 3, 0)


@pytest.mark.parametrize("change", [{"material": "sapphire"}, {"position": [0, 4, 0]}, {"scale": 2}])
def test_a_stone_of_that_name_with_other_settings_is_another_stone(change: dict[str, Any]) -> None:
    subject = fallen(session())
    ruby = settings(subject, "ruby")
    patch(subject, {"ruby": None})
    patch(subject, {"ruby": ruby | change})
    position, _ = subject.motion.latest().poses["ruby"]
    assert position == tuple((ruby | change)["position"])


def test_a_list_of_stones_removes_and_brings_back_as_well() -> None:
    subject = fallen(session())
    before, both = subject.motion.states(), [settings(subject, name) for name in ("ruby", "glass")]
    patch(subject, both[1:])
    patch(subject, both)
    assert_alike(subject.motion.states()["ruby"], before["ruby"])


def test_stones_of_another_scene_are_not_brought_back() -> None:
    subject = fallen(session())
    ruby = settings(subject, "ruby")
    patch(subject, {"ruby": None})
    events.apply(subject, SetScene(scene=SCENE | {"stones": SCENE["stones"][1:]}), NOTHING)
    patch(subject, {"ruby": ruby})
    assert len(subject.removals) == 0
    position, _ = subject.motion.latest().poses["ruby"]
    assert position == (0, 3, 0)


def test_a_change_that_is_refused_removes_nothing() -> None:
    subject = session()
    with pytest.raises(Exception, match="classic"):
        events.apply(
            subject, PatchScene(patch={"simulation": {"model": "classic"}, "stones": {"ruby": {"scale": 2}}}), NOTHING
        )
    assert len(subject.removals) == 0
    events.apply(subject, ToggleFall(), NOTHING)


def test_the_oldest_are_forgotten_and_meshes_of_those_that_may_come_back_are_known() -> None:
    removals, empty = Removals(), Scene(stones=())
    for number in range(REMEMBERED + 5):
        scene = Scene.read({"stones": [{"id": f"s{number}", "mesh": "ab" * 16}]})
        removals.changed(scene, empty, {f"s{number}": STATE}, falling=False)
    assert len(removals) == REMEMBERED
    assert removals.meshes() == {"ab" * 16}
    assert removals.returning(empty, Scene.read({"stones": [{"id": "s0", "mesh": "ab" * 16}]})) == {}
    last = Scene.read({"stones": [{"id": f"s{REMEMBERED + 4}", "mesh": "ab" * 16}]})
    assert [stone.state for stone in removals.returning(empty, last).values()] == [STATE]
    removals.clear()
    assert removals.meshes() == set()
