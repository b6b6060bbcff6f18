"""What the gateway remembers of a session, without an engine."""

from __future__ import annotations

import pytest

from culet.gateway.link import EngineLink
from culet.gateway.session_record import NO_DEMAND, SessionRecord
from culet.gateway.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads import Uploads, words
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Engine, State, Viewers

SETTINGS = GatewaySettings(control="ipc://unused", frames="ipc://unused")


@pytest.fixture
def sessions() -> Sessions:
    link = EngineLink(SETTINGS)
    return Sessions(SETTINGS, link, Uploads(link, 0))


def test_a_viewer_that_joins_has_the_latest_frame_at_once(sessions: Sessions) -> None:
    session = SessionRecord("ab" * 16, {})
    frame = Frame(session.topic, Codec.JPEG, Flags.FINAL, 7, 1, 1, 1, 3, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, b"picture")
    session.latest = (frame, frame.pack())
    assert sessions.join(session).next_frame(0) == frame.pack()


def test_a_viewer_that_joins_is_told_the_state_the_viewers_and_that_the_engine_is_down(sessions: Sessions) -> None:
    session = SessionRecord("ab" * 16, {"floor": {}})
    viewer = sessions.join(session)
    notices = [viewer.next_notice(0) for _ in range(4)]
    assert notices == [
        State(revision=0, scene={"floor": {}}, falling=False),
        Viewers(count=1),
        Engine(status="down"),
        None,
    ]


def test_the_demand_is_the_fastest_viewers_rate_at_the_size_of_the_one_who_has_watched_longest(
    sessions: Sessions,
) -> None:
    session = SessionRecord("ab" * 16, {})
    assert session.wanted(0) == NO_DEMAND
    desk, phone = sessions.join(session), sessions.join(session)
    now = phone.watching_since

    def wanted(time: float) -> tuple[float, int, int]:
        asked = session.wanted(time)
        return asked.frames_per_second, *asked.size

    desk.resize(1280, 720)
    phone.resize(390, 844)
    assert wanted(now) == (60, 1280, 720), "whoever said it last"
    desk.resize(1920, 1080)
    assert wanted(now) == (60, 1920, 1080)
    desk.show(False, now + 1)
    assert wanted(now + 1) == (60, 390, 844), "a hidden viewer's size does not count"
    desk.show(True, now + 2)
    assert wanted(now + 2) == (60, 390, 844), "who comes back has watched for less long"
    session.viewers.remove(phone)
    assert wanted(now + 3) == (60, 1920, 1080)
    desk.show(False, now + 4)
    assert session.wanted(now + 4) == NO_DEMAND


def test_the_bytes_that_frames_may_have_are_those_of_the_link_of_whoever_decides_their_size(sessions: Sessions) -> None:
    session = SessionRecord("ab" * 16, {})
    desk, phone = sessions.join(session), sessions.join(session)
    for viewer, size, seconds in ((desk, (1280, 720), 0.1), (phone, (390, 844), 1.0)):
        viewer.resize(*size)
        viewer.credit.take(1, 30_000, 0)
        viewer.credit.acknowledge(1, seconds)
    asked = session.wanted(phone.watching_since)
    assert (asked.bytes_per_frame, asked.bytes_at_rest) == (10_000, 225_000), "300 kB/s, at 30 frames a second"
    desk.show(False, 1)
    assert session.wanted(phone.watching_since + 2).bytes_per_frame == 1_000


def test_the_words_of_a_document_are_all_its_texts() -> None:
    scene = {"stones": [{"mesh": "a"}, {"mesh": None}, {}], "environment": {"kind": "image", "image": "b"}}
    assert words((scene, None, 3)) == {"a", "b", "image"}
