"""What the gateway remembers of a session, without an engine."""

from __future__ import annotations

import pytest

from culet.gateway.link import EngineLink
from culet.gateway.session_record import SessionRecord
from culet.gateway.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads import Uploads, words
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Engine, State, Viewers
from culet_protocol.sizes import LIVE_SIZE

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
    assert session.wanted(0) == (0, *LIVE_SIZE)
    desk, phone = sessions.join(session), sessions.join(session)
    now = phone.watching_since
    desk.resize(1280, 720)
    phone.resize(390, 844)
    assert session.wanted(now) == (60, 1280, 720), "whoever said it last"
    desk.resize(1920, 1080)
    assert session.wanted(now) == (60, 1920, 1080)
    desk.show(False, now + 1)
    assert session.wanted(now + 1) == (60, 390, 844), "a hidden viewer's size does not count"
    desk.show(True, now + 2)
    assert session.wanted(now + 2) == (60, 390, 844), "who comes back has watched for less long"
    session.viewers.remove(phone)
    assert session.wanted(now + 3) == (60, 1920, 1080)
    desk.show(False, now + 4)
    assert session.wanted(now + 4) == (0, *LIVE_SIZE)


def test_the_words_of_a_document_are_all_its_texts() -> None:
    scene = {"stones": [{"mesh": "a"}, {"mesh": None}, {}], "environment": {"kind": "image", "image": "b"}}
    assert words((scene, None, 3)) == {"a", "b", "image"}
