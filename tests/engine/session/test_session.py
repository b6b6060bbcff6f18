import json

import pytest

from culet.engine.session.history import History
from culet.engine.session.session import Session
from culet.engine.session.snapshot import SessionSnapshot
from culet.errors import InputError, NotFoundError
from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT
from culet.simulation.clock import MOST_WORK, WORK_SHARE
from culet.stage import Stage

NAME = "0123456789abcdef" * 2
SCENE = LEGACY_DEFAULT
STAGE = Stage.of(SCENE)


def fallen(seconds: float, *, frames: int = 7) -> Session:
    session = Session(NAME, STAGE)
    session.set_falling(True)
    for frame in range(frames + 1):
        session.advance(100 + seconds * frame / frames)
    return session


def test_the_step_grows_by_one_with_every_change_and_only_then() -> None:
    session = Session(NAME, STAGE)
    first = session.shown
    session.change(session.stage)
    assert session.shown is first
    session.change(session.stage.showing(session.scene.model_copy(update={"emitters": ()})))
    assert session.shown.step == first.step + 1
    session.advance(5)
    session.advance(6)
    assert session.shown.step == first.step + 1  # it does not fall


def test_how_often_it_is_looked_at_does_not_change_the_way_of_the_stone() -> None:
    positions = [fallen(0.21, frames=frames).pose() for frames in (1, 7, 200)]
    for pose in positions[1:]:
        assert pose is not None
        assert positions[0] is not None
        assert pose["position"] == pytest.approx(positions[0]["position"], abs=1e-9)  # measured 3e-15


def test_time_is_the_pictures_not_the_last_steps() -> None:
    assert fallen(0.05).shown.simulation_time == pytest.approx(0.05 - 1 / 120, abs=1e-9)  # drawn one step behind


def test_a_long_pause_between_frames_is_slow_motion_and_no_leap() -> None:
    session = Session(NAME, STAGE)
    session.set_falling(True)
    session.advance(0)
    session.advance(1000)
    assert session.shown.simulation_time <= 0.25


def test_of_a_stone_that_sleeps_not_even_the_time_shown_goes_on() -> None:
    session = fallen(10, frames=300)
    assert session.motion.falling
    assert session.motion.asleep
    resting = session.shown
    assert not resting.moving
    session.advance(200)
    session.advance(200.1)
    assert session.shown is resting


def test_what_was_shown_can_be_had_again_until_it_is_forgotten() -> None:
    session = Session(NAME, STAGE, history=History(3))
    session.set_falling(True)
    for frame in range(6):
        session.advance(frame / 60)
        session.remember(session.shown)
    latest = session.shown
    assert (session.recall(None).step, session.recall(None).scene) == (latest.step, latest.scene)
    assert session.recall(latest.step - 2).step == latest.step - 2
    with pytest.raises(NotFoundError, match=f"step {latest.step - 3} was never shown or is forgotten"):
        session.recall(latest.step - 3)
    with pytest.raises(NotFoundError):
        session.recall(latest.step + 1)


def test_a_restored_session_shows_the_same_and_moves_on_the_same() -> None:
    session = fallen(0.21)
    session.change(
        STAGE.showing(SCENE.model_copy(update={"camera": SCENE.camera.model_copy(update={"fov_degrees": 20.0})}))
    )
    report = json.loads(json.dumps(session.described()))
    restored = Session.restored(NAME, Stage.of(Scene.read(report["scene"])), SessionSnapshot.read(report["snapshot"]))
    assert restored.pose() == session.pose()
    assert restored.scene == session.scene
    assert restored.home == SCENE.camera
    assert restored.motion.falling
    for one in (session, restored):
        one.set_falling(True)
        one.advance(0)
        one.advance(0.2)
    assert restored.shown.scene == session.shown.scene


def test_a_restored_session_uses_no_number_again() -> None:
    session = fallen(0.2)
    session.sequence = 50
    restored = Session.restored(NAME, session.stage, session.snapshot())
    assert restored.shown.step > session.shown.step + 240
    assert restored.sequence > session.sequence + 240


@pytest.mark.parametrize("number", [1, 2**53 - 1001, 2**53 - 1000, 2**53 - 999, 2**53, 2**63 - 1])
def test_numbers_after_the_last_are_the_first_again_which_are_numbers_too(number: int) -> None:
    session = Session(NAME, Stage.of(Scene()))
    snapshot = session.snapshot().model_copy(update={"step": number, "sequence": number})
    restored = Session.restored(NAME, session.stage, snapshot).snapshot()
    assert 1 <= restored.step <= 2**53
    assert 0 <= restored.sequence < 2**53
    assert SessionSnapshot.read(restored.model_dump(mode="json")) == restored


def test_a_snapshot_that_is_none_is_refused_by_field() -> None:
    with pytest.raises(InputError, match="snapshot") as caught:
        SessionSnapshot.read(
            {"simulation": None, "fraction": 2, "falling": False, "home": {}, "step": 1, "sequence": 0}
        )
    assert caught.value.field == "snapshot.fraction"


def test_a_scene_without_a_stone_is_a_session_too() -> None:
    empty = Scene(stones=())
    session = Session(NAME, Stage.of(empty))
    session.advance(1)
    session.reset_stone()
    assert session.pose() is None
    assert session.shown.scene == empty
    assert Session.restored(NAME, Stage.of(empty), session.snapshot()).shown.scene == empty


class Processor:
    """A timer that each step of a session's stone moves on by so much."""

    def __init__(self, session: Session, seconds_a_step: float, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now, self.steps = 0.0, 0
        world = session.motion.world
        step = world.step

        def costly() -> None:
            self.now += seconds_a_step
            self.steps += 1
            step()

        monkeypatch.setattr(world, "step", costly)
        monkeypatch.setattr(session.motion, "_timer", lambda: self.now)


def costly_fall(seconds_a_step: float, frame: float, monkeypatch: pytest.MonkeyPatch) -> tuple[Session, list[float]]:
    """Frames of 4 s, each begun so long after the last and its steps; the processor time of each."""
    session = Session(NAME, STAGE)
    processor = Processor(session, seconds_a_step, monkeypatch)
    session.set_falling(True)
    session.advance(0)
    spent: list[float] = []
    now = 0.0
    while now < 4:
        before = processor.now
        now += frame + (spent[-1] if spent else 0.0)
        session.advance(now)
        spent.append(processor.now - before)
    return session, spent


@pytest.mark.parametrize("seconds_a_step", [0.004, 0.03, 1.0])
def test_steps_that_take_too_long_leave_half_of_the_time_to_others(
    seconds_a_step: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, spent = costly_fall(seconds_a_step, 1 / 30, monkeypatch)
    assert max(spent) <= MOST_WORK + seconds_a_step  # measured: 0.024, 0.03 and 1
    assert sum(spent) <= WORK_SHARE * 4 + MOST_WORK + seconds_a_step  # measured: 1.53, 1.92 and 3
    assert session.shown.simulation_time < 4  # slow motion
    assert session.motion.clock.dropped > 0


def test_steps_that_a_frame_has_time_for_are_all_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    session, _ = costly_fall(0.001, 1 / 30, monkeypatch)
    assert session.motion.clock.dropped == 0


def test_giving_up_steps_does_not_change_those_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    session, _ = costly_fall(0.03, 1 / 30, monkeypatch)
    alone = Session(NAME, STAGE)
    for _ in range(session.motion.world.state.step):
        alone.motion.world.step()
    assert session.motion.world.state == alone.motion.world.state


def test_a_stone_that_cannot_be_simulated_stops_and_so_does_one_restored(monkeypatch: pytest.MonkeyPatch) -> None:
    session = fallen(0.21)
    report = json.loads(json.dumps(session.described()))
    restored = Session.restored(NAME, Stage.of(Scene.read(report["scene"])), SessionSnapshot.read(report["snapshot"]))
    for one in (session, restored):
        assert one.motion.falling

        def failing() -> None:
            raise ZeroDivisionError

        monkeypatch.setattr(one.motion.world, "step", failing)
        if one is restored:  # it begins to count time with its first frame
            one.advance(200)
        with pytest.raises(ZeroDivisionError):
            one.advance(201)
        assert (one.motion.falling, one.motion.moving, one.shown.moving) == (False, False, False)
        one.advance(202)  # nothing more is tried
