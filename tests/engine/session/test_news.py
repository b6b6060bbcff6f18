"""What gateways are told of an edit: what it changed, however many stones there are."""

from __future__ import annotations

from typing import Any

import pytest

from culet.engine.session import events
from culet.engine.session.news import News, scene_parts
from culet.engine.session.session import Session
from culet.scene import Scene
from culet.stage import NOTHING, Stage
from culet_protocol.messages import Orbit, PatchScene, SessionEvent, ToggleFall
from culet_protocol.parts import with_parts

FIFTY = Scene.read({"stones": [{"id": f"stone-{n}", "position": [n, 0, 0]} for n in range(50)]})
NAME = "ab" * 16


def session(**scene: Any) -> Session:  # noqa: ANN401
    return Session(NAME, Stage.of(Scene.read(scene)))


@pytest.mark.parametrize(
    "after",
    [
        FIFTY.model_copy(update={"camera": FIFTY.camera.model_copy(update={"fov_degrees": 20.0})}),
        FIFTY.model_copy(update={"stones": FIFTY.stones[1:]}),
        FIFTY.model_copy(
            update={"stones": (*FIFTY.stones[:-1], FIFTY.stones[-1].model_copy(update={"material": "ruby"}))}
        ),
    ],
    ids=["the camera", "a stone less", "another material"],
)
def test_an_edit_of_a_scene_of_fifty_stones_tells_one_part(after: Scene) -> None:
    parts = scene_parts(FIFTY, after)
    assert len(parts) == 1
    assert with_parts(FIFTY.model_dump(mode="json"), parts) == after.model_dump(mode="json")


def test_a_gateway_that_heard_all_changes_knows_all() -> None:
    subject = session()
    scene, snapshot = subject.described()["scene"], subject.described()["snapshot"]
    edits: list[SessionEvent] = [
        Orbit(yaw=0.1, pitch=0),
        PatchScene(patch={"stones": {"stone": {"material": "ruby"}}, "floor": {"kind": "matte"}}),
        ToggleFall(),
    ]
    for revision, edit in enumerate(edits, 1):
        events.apply(subject, edit, NOTHING)
        change = subject.change_told(edited=True)
        assert (change.revision, change.since) == (revision, revision - 1)
        scene, snapshot = with_parts(scene, change.parts), snapshot | change.moved
    subject.advance(0)
    subject.advance(0.1)
    snapshot |= subject.motion_told().moved
    assert scene == subject.described()["scene"]
    assert snapshot == subject.described()["snapshot"]


def test_while_stones_move_a_pointers_event_does_not_repeat_their_motion() -> None:
    subject = session(stones=[{"position": [0, 4, 0]}])
    subject.set_falling(True)
    subject.advance(0)
    subject.change_told(edited=True)
    subject.advance(0.1)
    events.apply(subject, Orbit(yaw=0.1, pitch=0), NOTHING)
    change = subject.change_told(edited=True)
    assert change.parts.keys() == {"camera"}
    assert "simulation" not in change.moved
    assert len(change.model_dump_json()) < 600  # measured 520
    assert "simulation" in subject.motion_told().moved


def test_what_was_told_once_is_not_told_again() -> None:
    subject = session()
    news = News(NAME, Scene(), subject.condition())
    snapshot = subject.snapshot().model_dump(mode="json")
    first, second = (
        news.change(subject.scene, subject.condition(), snapshot, moving=False, edited=True) for _ in range(2)
    )
    assert "simulation" in first.moved
    assert second.moved == {}
