"""What one viewer is given next, without sockets."""

from __future__ import annotations

from culet.gateway.viewers.credit import FIRST_WINDOW
from culet.gateway.viewers.viewer import NOTICES_WAITING, SETTLING_SECONDS, STATE_SECONDS, Standing, Viewer
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Change, Engine, Pong, Problem, State, Viewers


def offer(viewer: Viewer, sequence: int) -> bytes:
    numbers = sequence, 1, 1, 1, 3, 1, 0, sequence, 0, 0, 0, 0, 0, 0, 0
    frame = Frame(bytes(16), Codec.JPEG, Flags.NONE, *numbers, b"picture")
    message = frame.pack()
    viewer.offer(frame, message, 0)
    return message


def test_with_credit_the_latest_frame_goes_out_once() -> None:
    viewer = Viewer(1, now=0)
    offer(viewer, 1)
    latest = offer(viewer, 2)
    assert viewer.next_frame(0) == latest
    viewer.acknowledge(2, 0.1)
    offer(viewer, 2)  # a still picture is repeated
    assert viewer.next_frame(0.1) is None
    newer = offer(viewer, 3)
    assert viewer.next_frame(0.1) == newer


def test_frames_that_come_without_credit_are_skipped_and_the_last_is_never_lost() -> None:
    viewer = Viewer(1, now=0)
    for sequence in range(1, FIRST_WINDOW + 1):
        offer(viewer, sequence)
        assert viewer.next_frame(0)
    for sequence in range(FIRST_WINDOW + 1, 20):
        last = offer(viewer, sequence)
        assert viewer.next_frame(0) is None
    assert viewer.next_frame(3600) is None, "credit does not come back with time"
    viewer.acknowledge(FIRST_WINDOW, 0.1)
    assert viewer.next_frame(0.1) == last


def test_a_hidden_viewer_gets_the_latest_when_it_is_shown() -> None:
    viewer = Viewer(1, now=0)
    viewer.show(False, 0)
    message = offer(viewer, 1)
    assert viewer.next_frame(0) is None
    viewer.show(True, 0)
    assert viewer.next_frame(0) == message


def test_frames_are_wanted_once_the_size_is_known_or_the_viewer_had_time_to_say_it() -> None:
    viewer = Viewer(1, now=0)
    assert viewer.rate(0) == 0
    assert viewer.rate(SETTLING_SECONDS) > 0
    viewer = Viewer(1, now=0)
    viewer.resize(640, 360)
    assert viewer.rate(0.01) > 0


def test_after_a_restart_of_the_engine_the_same_number_is_another_frame() -> None:
    viewer = Viewer(1, now=0)
    offer(viewer, 1)
    viewer.next_frame(0)
    viewer.restart()
    message = offer(viewer, 1)
    viewer.acknowledge(1, 0.1)
    assert viewer.next_frame(0.1) == message


def test_restarts_of_the_engine_put_no_more_frames_in_flight() -> None:
    viewer = Viewer(1, now=0)
    sent = 0
    for _ in range(10):
        viewer.restart()
        for sequence in range(1, FIRST_WINDOW + 1):
            offer(viewer, sequence)
            sent += viewer.next_frame(0) is not None
    assert sent == FIRST_WINDOW


def test_of_what_only_the_latest_matters_of_only_the_latest_waits() -> None:
    viewer = Viewer(1, now=0)
    refused = Problem(code="malformed", message="the same")
    for number in range(1000):
        viewer.tell(State(revision=0, scene={"version": number}, falling=False))
        viewer.tell(Viewers(count=number))
        viewer.tell(Engine(status="down" if number % 2 else "up"))
        viewer.tell(refused)
    told = [viewer.next_notice(0) for _ in range(5)]
    assert told == [
        State(revision=0, scene={"version": 999}, falling=False),
        Viewers(count=999),
        Engine(status="down"),
        refused,
        None,
    ]
    assert viewer.standing is Standing.ATTENDING


def test_states_are_told_at_a_rate_that_eyes_follow_and_the_last_is_told() -> None:
    viewer = Viewer(1, now=0)
    told: list[State | Change] = []
    for number in range(1001):  # 1 s of a thousand edits
        viewer.tell(State(revision=0, scene={"version": number}, falling=False))
        notice = viewer.next_notice(number / 1000)
        told += [notice] if isinstance(notice, State | Change) else []
    assert 1 / STATE_SECONDS - 1 <= len(told) <= 1 / STATE_SECONDS + 1
    due = viewer.sleep_until()
    if due is not None:
        last = viewer.next_notice(due)
        told += [last] if isinstance(last, Change) else []
    assert isinstance(told[-1], Change)
    assert told[-1].parts == {"version": 1000}
    assert viewer.sleep_until() is None


def test_a_viewer_that_knows_a_scene_is_told_what_has_changed_since() -> None:
    """However many states it missed; and of a stone only that stone."""
    viewer = Viewer(1, now=0)
    stones = [{"id": f"s{number}", "position": [number, 0, 0]} for number in range(50)]
    scenes = [{"camera": {"up": turn}, "stones": stones} for turn in range(3)]
    scenes.append({**scenes[-1], "stones": [*stones[:7], {"id": "s7", "position": [0, 1, 0]}, *stones[8:]]})
    viewer.tell(State(revision=4, scene=scenes[0], falling=False))
    assert viewer.next_notice(0) == State(revision=4, scene=scenes[0], falling=False)
    for revision, scene in enumerate(scenes[1:], 5):
        viewer.tell(State(revision=revision, scene=scene, falling=True))
    change = viewer.next_notice(1)
    assert change == Change(
        revision=7, since=4, falling=True,
        parts={"camera": {"up": 2}, "stones.s7": {"id": "s7", "position": [0, 1, 0]}},
    )  # fmt: skip
    assert len(change.model_dump_json()) < 250  # measured 205; the whole scene has 2.3 kB


def test_a_state_that_has_to_wait_holds_up_nothing_else() -> None:
    viewer = Viewer(1, now=0)
    viewer.tell(State(revision=0, scene={}, falling=False))
    assert viewer.next_notice(0) == State(revision=0, scene={}, falling=False)
    viewer.tell(State(revision=0, scene={}, falling=True))
    viewer.tell(Pong(time=1))
    assert viewer.next_notice(0) == Pong(time=1)
    assert viewer.next_notice(0) is None
    assert viewer.next_notice(STATE_SECONDS) == Change(revision=0, since=0, parts={}, falling=True)


def test_whose_stream_ends_is_told_the_last_state_at_once() -> None:
    viewer = Viewer(1, now=0)
    viewer.tell(State(revision=0, scene={}, falling=False))
    viewer.next_notice(0)
    viewer.tell(State(revision=0, scene={}, falling=True))
    assert viewer.next_notice(0) is None
    viewer.dismiss()
    assert viewer.next_notice(0) == Change(revision=0, since=0, parts={}, falling=True)


def test_a_viewer_that_leaves_its_notices_unread_is_noticed() -> None:
    viewer = Viewer(1, now=0)
    for number in range(NOTICES_WAITING):
        viewer.tell(Pong(time=number))
    before = viewer.standing
    viewer.tell(Pong(time=0))
    assert (before, viewer.standing) == (Standing.ATTENDING, Standing.OVERRUN)
