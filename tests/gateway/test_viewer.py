"""What one viewer is given next, without sockets."""

from __future__ import annotations

from culet.gateway.credit import IN_FLIGHT_SECONDS, WINDOW
from culet.gateway.viewer import NOTICES_WAITING, SETTLING_SECONDS, Viewer
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Pong, State, Viewers


def offer(viewer: Viewer, sequence: int) -> bytes:
    numbers = sequence, 1, 1, 1, 3, 1, 0, sequence, 0, 0, 0, 0, 0, 0, 0
    frame = Frame(bytes(16), Codec.JPEG, Flags.NONE, *numbers, b"picture")
    message = frame.pack()
    viewer.offer(frame, message)
    return message


def test_with_credit_the_latest_frame_goes_out_once() -> None:
    viewer = Viewer(1, now=0)
    offer(viewer, 1)
    latest = offer(viewer, 2)
    assert viewer.next_frame(0) == latest
    offer(viewer, 2)  # a still picture is repeated once a second
    assert viewer.next_frame(0) is None


def test_frames_that_come_without_credit_are_skipped_and_the_last_is_never_lost() -> None:
    viewer = Viewer(1, now=0)
    for sequence in range(1, WINDOW + 1):
        offer(viewer, sequence)
        assert viewer.next_frame(0)
    for sequence in range(WINDOW + 1, 20):
        last = offer(viewer, sequence)
        assert viewer.next_frame(0) is None
    assert viewer.sleep_until() == IN_FLIGHT_SECONDS
    viewer.acknowledge(WINDOW, 0.1)
    assert viewer.next_frame(0.1) == last


def test_a_hidden_viewer_gets_the_latest_when_it_is_shown() -> None:
    viewer = Viewer(1, now=0)
    viewer.show(False, 0)
    message = offer(viewer, 1)
    assert viewer.next_frame(0) is None
    assert viewer.sleep_until() is None
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
    assert viewer.next_frame(0) == message


def test_of_waiting_states_only_the_latest_is_told() -> None:
    viewer = Viewer(1, now=0)
    viewer.tell(State(scene={"old": 1}, falling=False))
    viewer.tell(Viewers(count=2))
    viewer.tell(State(scene={"new": 1}, falling=True))
    assert viewer.next_notice() == Viewers(count=2)
    assert viewer.next_notice() == State(scene={"new": 1}, falling=True)
    assert viewer.next_notice() is None


def test_a_viewer_that_leaves_its_notices_unread_is_noticed() -> None:
    viewer = Viewer(1, now=0)
    for number in range(NOTICES_WAITING):
        viewer.tell(Pong(time=number))
    assert not viewer.overrun
    viewer.tell(Pong(time=0))
    assert viewer.overrun
