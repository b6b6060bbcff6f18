"""Edits of a session's scene are taken back and made again."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from culet.engine.session import events
from culet.engine.session.edits import KEPT, STONES_KEPT, TOGETHER, Edits, Moment, paths_of
from culet.engine.session.session import Session
from culet.errors import InputError
from culet.optics.sky_files.picture import SkyPicture
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.simulation.bodies import BodyState
from culet.stage import Library, Stage
from culet_protocol.messages import (
    Balance,
    Dolly,
    LookAtStone,
    Orbit,
    PatchScene,
    Push,
    Redo,
    ResetCamera,
    ResetStone,
    SessionEvent,
    SetScene,
    ToggleEnvironment,
    ToggleFall,
    ToggleMirror,
    ToggleWalls,
    Translate,
    Undo,
)

SKY = SkyPicture(np.full((4, 8, 3), 0.5, np.float32))
WITH_SKY = Library({}, {"sunset": SKY})


class Clock:
    """Stands still until it is told to go on."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def subject(clock: Clock) -> Session:
    return diamond(clock)


def diamond(clock: Clock) -> Session:
    stage = Stage.of(legacy({"floor": {"kind": "matte"}}))
    session = Session("0" * 32, stage, sky=events.own_sky(stage.sky))
    session.edits = Edits(clock)
    return session


def happen(subject: Session, *happened: SessionEvent, library: Library = WITH_SKY) -> Scene:
    for event in happened:
        events.apply(subject, event, library)
    return subject.scene


def patch(**changes: Any) -> PatchScene:  # noqa: ANN401
    return PatchScene(patch=changes)


@pytest.mark.parametrize(
    "event",
    [
        ToggleMirror(),
        ToggleEnvironment(),
        ToggleWalls(),
        patch(stones={"stone": {"material": "ruby"}}),
        patch(stones={"stone": {"cut": {"crown_degrees": 30}}}),
        patch(stones={"other": {"cut": "brilliant", "position": [5, 0, 0]}}),
        patch(stones={"stone": None}),
        patch(stones=[]),
        patch(environment={"kind": "image", "image": "sunset"}),
        patch(optics={"polarised": True}, camera={"fov_degrees": 20}),
        Translate(target="light_1", right=1, up=0),
        SetScene(scene={"stones": [{"id": "other", "material": "ruby"}], "camera": {"fov_degrees": 20}}),
    ],
    ids=lambda event: " ".join(map(str, event.model_dump(exclude_defaults=True).values())) or event.type,
)
def test_every_edit_is_taken_back_and_made_again(subject: Session, event: SessionEvent) -> None:
    before = subject.moment
    assert not subject.condition().can_undo
    happen(subject, event)
    after = subject.moment
    assert after != before
    happen(subject, Undo())
    assert subject.moment == before
    assert (subject.condition().can_undo, subject.condition().can_redo) == (False, True)
    happen(subject, Redo())
    assert subject.moment == after
    assert (subject.condition().can_undo, subject.condition().can_redo) == (True, False)


@pytest.mark.parametrize(
    "event",
    [
        Orbit(yaw=1, pitch=0.1),
        Translate(right=1, up=0),
        Dolly(forward=1),
        ResetCamera(),
        LookAtStone(),
        patch(camera={"fov_degrees": 20}),
        ToggleFall(),
        ResetStone(),
        Push(x=0, y=0, right=1, up=1),
        Balance(exactness=1, pinned=True),
        patch(floor={"kind": "matte"}),
    ],
    ids=lambda event: event.type,
)
def test_what_changes_nothing_of_the_scene_but_the_view_is_no_edit(subject: Session, event: SessionEvent) -> None:
    happen(subject, event)
    assert not subject.edits.can_undo
    happen(subject, ToggleMirror(), Undo(), event)
    assert subject.edits.can_redo


def test_edits_are_taken_back_one_after_the_other_and_another_edit_ends_what_could_be_made_again(
    subject: Session,
) -> None:
    scenes = [subject.scene] + [
        happen(subject, edit) for edit in (ToggleMirror(), ToggleEnvironment(), patch(stones=[]))
    ]
    assert [happen(subject, Undo()) for _ in range(3)] == scenes[2::-1]
    with pytest.raises(InputError, match="no edit to undo"):
        happen(subject, Undo())
    assert happen(subject, Redo()) == scenes[1]
    happen(subject, patch(stones=[]))
    with pytest.raises(InputError, match="no undone edit"):
        happen(subject, Redo())


def stones(number: int) -> dict[str, Any]:
    return {"cut": "brilliant", "position": [3 * number, 2, 9], "scale": 0.5 + number / 8}


EVENTS = some.one_of(
    some.sampled_from(
        [
            *(Undo(), Undo(), Redo(), ToggleFall(), Orbit(yaw=0.1, pitch=0), ResetCamera()),
            *(ToggleMirror(), ToggleEnvironment(), ToggleWalls(), Translate(target="light_2", right=0.1, up=0)),
            SetScene(scene={"stones": [{"id": "stone", "material": "ruby"}], "camera": {"fov_degrees": 9}}),
            *(patch(environment={"kind": kind}) for kind in ("studio", "dark")),
            *(patch(environment={"kind": "image", "image": image}) for image in ("sunset", "ring-lights")),
        ]
    ),
    some.integers(1, 3).map(lambda gravity: patch(simulation={"gravity": gravity})),
    some.integers(0, 3).map(lambda number: patch(stones={f"s{number}": stones(number)})),
    some.integers(0, 3).map(lambda number: patch(stones={f"s{number}": None})),
    some.integers(0, 3).map(lambda number: patch(stones=[{"id": "stone", **stones(number)}])),
)


@given(some.lists(some.tuples(EVENTS, some.sampled_from([0.1, 2 * TOGETHER])), max_size=20))
def test_all_edits_taken_back_give_the_first_scene_and_made_again_the_last(
    happened: list[tuple[SessionEvent, float]],
) -> None:
    """Whatever was undone and made again between, and however the stones fell meanwhile."""
    clock = Clock()
    subject = diamond(clock)
    first = subject.moment
    for event, seconds in happened:
        with contextlib.suppress(InputError):  # of what cannot be: to undo nothing, to let nothing fall
            happen(subject, event)
        subject.advance(clock.now)
        clock.now += seconds
    last = made_again(subject)
    while subject.edits.can_undo:
        happen(subject, Undo())
    assert seen_as(subject.moment) == seen_as(first)
    assert seen_as(made_again(subject)) == seen_as(last)


def made_again(subject: Session) -> Moment:
    while subject.edits.can_redo:
        happen(subject, Redo())
    return subject.moment


def seen_as(moment: Moment) -> object:
    """Without the view, which is nobody's edit."""
    return moment.scene.model_copy(update={"camera": None}), moment.own, moment.surroundings


def test_a_slider_that_is_dragged_is_one_edit_and_a_second_later_another(subject: Session, clock: Clock) -> None:
    before = subject.scene
    for gravity in (1, 2, 3):
        clock.now += 0.5 * TOGETHER
        first = happen(subject, patch(simulation={"gravity": gravity}))
    clock.now += TOGETHER
    happen(subject, patch(simulation={"gravity": 4}))
    happen(subject, patch(simulation={"friction": 1}))
    assert happen(subject, Undo()).simulation.gravity == 4
    assert happen(subject, Undo()) == first
    assert happen(subject, Undo()) == before


def test_a_slider_that_is_dragged_there_and_back_leaves_nothing_to_undo(subject: Session) -> None:
    gravity = subject.scene.simulation.gravity
    happen(subject, patch(simulation={"gravity": 1}), patch(simulation={"gravity": gravity}))
    assert not subject.edits.can_undo


def test_a_switch_is_an_edit_however_soon_it_follows(subject: Session) -> None:
    happen(subject, ToggleMirror(), ToggleMirror())
    assert happen(subject, Undo()).floor.kind == "mirror"


def test_what_follows_an_undone_drag_is_another_edit(subject: Session) -> None:
    happen(subject, patch(simulation={"gravity": 1}), Undo(), Redo(), patch(simulation={"gravity": 2}))
    assert happen(subject, Undo()).simulation.gravity == 1


def test_the_view_stays_where_it_is(subject: Session) -> None:
    happen(subject, ToggleMirror())
    camera = happen(subject, Orbit(yaw=1, pitch=0.1), Dolly(forward=1)).camera
    happen(subject, patch(camera={"fov_degrees": 20}))
    home, camera = subject.home, subject.scene.camera
    scene = happen(subject, Undo())
    assert (scene.camera, scene.floor.kind) == (camera, "matte")
    assert (happen(subject, Redo()).camera, subject.home) == (camera, home)


def test_the_view_stays_though_it_was_turned_during_a_drag(subject: Session) -> None:
    happen(subject, patch(simulation={"gravity": 1}), Orbit(yaw=1, pitch=0), patch(simulation={"gravity": 2}))
    camera = subject.scene.camera
    assert happen(subject, Undo()).camera == camera


def test_a_scene_that_took_the_place_of_another_gives_it_back_as_it_was_looked_at(subject: Session) -> None:
    camera = happen(subject, Orbit(yaw=1, pitch=0.1)).camera
    happen(subject, SetScene(scene={}))
    turned = happen(subject, Orbit(yaw=2, pitch=0.1)).camera
    assert happen(subject, Undo()).camera == camera
    assert happen(subject, Redo()).camera == turned


def test_the_others_fall_on_when_an_edit_of_one_stone_is_taken_back(subject: Session) -> None:
    happen(subject, patch(stones={"other": {"cut": "brilliant", "position": [5, 8, 0]}}), ToggleFall())
    happen(subject, patch(stones={"stone": {"material": "ruby"}}))
    fallen = fall(subject)["other"].position[1]
    assert fallen < 8
    happen(subject, Undo())
    assert subject.motion.falling
    assert subject.motion.states()["other"].position[1] == fallen


def fall(subject: Session, seconds: float = 0.2) -> dict[str, BodyState]:
    subject.advance(0)
    subject.advance(seconds)
    return subject.motion.states()


@pytest.fixture
def high() -> Session:
    """Of a stone high up, that fell for a while."""
    subject = Session("0" * 32, Stage.of(Scene.read({"stones": [{"position": [0, 9, 0], "spin": [1, 2, 3]}]})))
    happen(subject, ToggleFall())
    assert fall(subject)["stone"].position[1] < 9
    return subject


@pytest.mark.parametrize(
    "event",
    [
        patch(stones={"stone": {"scale": 0.5}}),
        patch(stones={"stone": {"cut": {"crown_degrees": 30}}}),
        patch(stones={"stone": {"position": [3, 3, 3]}}),
        patch(stones={"stone": None}),
        SetScene(scene={"stones": [{"position": [0, 9, 0], "spin": [1, 2, 3]}]}),
        SetScene(scene={"stones": [{"id": "other", "position": [0, 9, 0]}]}),
    ],
    ids=["scale", "cut", "position", "removed", "set anew", "another scene"],
)
def test_a_stone_that_the_edit_moved_goes_back_to_where_it_was_and_falls_on(high: Session, event: SessionEvent) -> None:
    before = high.motion.states()["stone"]
    happen(high, event)
    assert high.motion.states().get("stone") != before
    happen(high, Undo())
    back = high.motion.states()["stone"]
    assert (back.position, back.orientation, back.velocity) == (before.position, before.orientation, before.velocity)
    assert high.motion.falling
    high.motion.pause()
    assert fall(high)["stone"].position[1] < back.position[1]
    happen(high, Redo(), Undo())
    assert high.motion.states()["stone"].position[1] < back.position[1], "its fall since is no edit"


def test_a_stone_that_the_edit_did_not_move_is_not_moved_back_in_time(high: Session) -> None:
    happen(high, patch(stones={"stone": {"material": "ruby"}}), patch(simulation={"gravity": 3}), ToggleFall())
    before = high.motion.states()["stone"]
    happen(high, Undo(), Undo())
    after = high.motion.states()["stone"]
    assert (after.position, after.orientation, after.velocity) == (before.position, before.orientation, before.velocity)
    assert not high.motion.falling, "the pause is no edit"


ROW = [("b", 3), ("c", 6)]


def test_several_stones_that_an_edit_moved_go_back(subject: Session) -> None:
    happen(subject, patch(stones={name: {"cut": "brilliant", "position": [x, 5, 0]} for name, x in ROW}))
    happen(subject, ToggleFall())
    before = fall(subject)
    happen(subject, patch(stones={name: {"position": [x, 2, 5]} for name, x in ROW}), ResetStone(stone="b"))
    happen(subject, Undo())
    after = subject.motion.states()
    assert [after[name].position for name, _ in ROW] == [before[name].position for name, _ in ROW]
    assert after["stone"].position == before["stone"].position


def test_a_stone_that_was_dragged_goes_back_to_where_it_was_before_the_drag(subject: Session) -> None:
    happen(subject, ToggleFall())
    before = fall(subject)["stone"].position
    happen(subject, *(patch(stones={"stone": {"position": [x, 5, 0]}}) for x in (1, 2, 3)))
    happen(subject, Undo())
    assert subject.motion.states()["stone"].position == before


def test_a_sky_that_is_not_kept_any_more_is_told_of_and_nothing_changes(subject: Session) -> None:
    happen(subject, patch(environment={"kind": "image", "image": "sunset"}), ToggleMirror())
    mirrored = happen(subject, patch(environment={"kind": "dark"}))
    with pytest.raises(InputError, match=r"not kept any more: .*sunset"):
        happen(subject, Undo(), library=Library())
    assert subject.scene == mirrored
    assert happen(subject, Undo()).environment.kind == "image"


def test_so_many_edits_are_kept_and_fewer_of_many_stones(subject: Session) -> None:
    small, large = subject.moment, Scene.read({"stones": [{"id": f"s{number}"} for number in range(64)]})
    edits = Edits()
    for number in range(KEPT + 5):
        edits.note(str(number), small, with_scene(small, subject.scene.model_copy(update={"film": number})))
    assert len(edits) == KEPT
    for number in range(KEPT):
        edits.note(str(number), with_scene(small, large), with_scene(small, large.model_copy(update={"film": number})))
    assert len(edits) == STONES_KEPT // 64


def with_scene(moment: Moment, scene: Scene) -> Moment:
    return replace(moment, scene=scene)


def test_patches_of_the_same_fields_have_the_same_paths() -> None:
    assert paths_of({"b": 1, "a": {"d": 2, "c": None}}) == "a.c a.d b"
    assert paths_of({"stones": {"ruby": {"scale": 2}}}) != paths_of({"stones": {"emerald": {"scale": 2}}})
    assert paths_of({"walls": {}}) == "walls"
