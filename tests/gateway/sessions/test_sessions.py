"""What the gateway remembers of a session, without an engine."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from typing import Any

import pytest

from culet.engine.session.session import Session
from culet.errors import EngineUnavailableError, NotFoundError
from culet.gateway.engine.link import EngineLink
from culet.gateway.sessions.session_places import SessionPlaces
from culet.gateway.sessions.session_record import NO_DEMAND, SessionRecord
from culet.gateway.sessions.sessions import Sessions
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads.uploads import Uploads, words
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.engine import CloseSession, GetSession, OpenSession
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import Engine, Message, State, Viewers

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


def asked_about(_: Sessions, session: SessionRecord) -> None:
    session.asked += 1


def used(sessions: Sessions, session: SessionRecord) -> None:
    sessions.get(session.id)
    session.used += 1  # however coarse the clock is


def joined(sessions: Sessions, session: SessionRecord) -> None:
    sessions.join(session)


def left_alone(*_: object) -> None:
    pass


@pytest.mark.parametrize("meanwhile", [left_alone, used, asked_about, joined])
async def test_a_session_that_is_used_while_the_engine_says_who_watches_does_not_expire(
    sessions: Sessions, monkeypatch: pytest.MonkeyPatch, meanwhile: Callable[[Sessions, SessionRecord], None]
) -> None:
    session = sessions._sessions["ab" * 16] = SessionRecord("ab" * 16, {})
    told: list[type[Message]] = []

    async def request(_: EngineLink, message: Message) -> tuple[dict[str, Any], bytes]:
        told.append(type(message))
        meanwhile(sessions, session)
        return {"watched": False}, b""

    monkeypatch.setattr(EngineLink, "request", request)
    await sessions._expire(session)
    assert told == ([GetSession, CloseSession] if meanwhile is left_alone else [GetSession])
    assert (session.id in sessions) is (meanwhile is not left_alone)


def test_waiting_for_an_answer_about_a_session_is_using_it_until_then() -> None:
    session = SessionRecord("ab" * 16, {})
    with session.awaited():
        with session.awaited():
            pass
        assert session.asked == 1
        session.used = 0
    assert session.asked == 0
    assert session.used > 0


@pytest.mark.parametrize("meanwhile", [False, True], ids=["before", "while the engine says who watches"])
async def test_a_session_about_which_somebody_waits_for_an_answer_makes_no_room(*, meanwhile: bool) -> None:
    """Though it was used longest ago."""
    asked, idle, new = (SessionRecord(name * 32, {}, owner) for name, owner in zip("abc", ("x", "x", "y"), strict=True))
    records, closed = {session.id: session for session in (asked, idle, new)}, list[SessionRecord]()

    async def close(session: SessionRecord, _: str) -> None:
        closed.append(records.pop(session.id))

    async def watched_elsewhere(session: SessionRecord) -> bool:
        if session is asked:
            assert meanwhile, "the engine is not even asked"
            asked.asked += 1
        return False

    if not meanwhile:
        asked.asked += 1
    places = SessionPlaces(SETTINGS.model_copy(update={"max_sessions": 2}), records, close, watched_elsewhere)
    await places.make_room(new)
    assert closed == [idle]


class SlowEngine(EngineLink):
    """Has lost the session, and opens it when it is let."""

    def __init__(self, settings: GatewaySettings) -> None:
        super().__init__(settings)
        self.let = asyncio.Event()
        self.opened: list[bool] = []
        """Whether the gateway waits for it as long as that takes."""
        self.closed: list[str] = []
        self.given_up = 0

    async def request(
        self,
        message: Message,
        payload: bytes | bytearray | None = None,
        *,
        patient: bool = False,
        for_asker: bool = False,
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        if isinstance(message, OpenSession):
            self.opened.append(patient)
            try:
                await self.let.wait()
            except asyncio.CancelledError:
                self.given_up += 1
                raise
        elif not self.let.is_set():
            raise NotFoundError("no such session; it may have expired")
        elif isinstance(message, CloseSession):
            self.closed.append(message.session)
        stage = Stage.of(Scene())
        return Session("ab" * 16, stage).described() | {"findings": [], "falling": True}, b""


async def test_a_session_whose_shapes_take_long_is_given_again_once_for_all_however_long_that_takes() -> None:
    settings = SETTINGS.model_copy(update={"request_seconds": 0.01})
    link = SlowEngine(settings)
    sessions = Sessions(settings, link, Uploads(link, 0))
    session = SessionRecord("ab" * 16, {})
    sessions._sessions[session.id] = session
    session.revision = 1
    for _ in range(2):
        with pytest.raises(EngineUnavailableError, match="still being made again; try again later"):
            await sessions.describe(session)
    anew = asyncio.create_task(sessions._give_again(session))  # as when an engine has come
    leaves = asyncio.create_task(sessions.describe(session))
    await asyncio.sleep(0)
    leaves.cancel()
    assert not anew.done()
    link.let.set()
    await anew
    assert (link.opened, link.given_up) == ([True], 0)
    assert session.scene == Scene().model_dump(mode="json")
    assert not sessions._giving
    assert (await sessions.describe(session))["scene"] == session.scene


async def test_a_session_that_nobody_has_seen_is_given_up_with_who_asks_for_it() -> None:
    link = SlowEngine(SETTINGS)
    sessions = Sessions(SETTINGS, link, Uploads(link, 0))
    session = SessionRecord("ab" * 16, {})
    sessions._sessions[session.id] = session
    leaves = asyncio.create_task(sessions.describe(session))
    while not link.opened:  # noqa: ASYNC110 - it says nothing
        await asyncio.sleep(0)
    leaves.cancel()
    await asyncio.wait([leaves])
    assert (link.opened, link.given_up) == ([False], 1)


async def test_a_session_that_is_closed_while_it_is_given_again_does_not_stay_in_the_engine() -> None:
    link = SlowEngine(SETTINGS)
    sessions = Sessions(SETTINGS, link, Uploads(link, 0))
    session = sessions._sessions["ab" * 16] = SessionRecord("ab" * 16, {})
    session.revision = 1
    giving = asyncio.create_task(sessions._give_again(session))
    while not link.opened:  # noqa: ASYNC110 - it says nothing
        await asyncio.sleep(0)
    await sessions.close(session)
    assert link.closed == [], "it was not there yet"
    link.let.set()
    with pytest.raises(NotFoundError, match="closed meanwhile"):
        await giving
    assert link.closed == [session.id]
    with pytest.raises(NotFoundError, match="closed meanwhile"):
        await sessions._give_again(session)
    assert len(link.opened) == 1


async def test_a_session_made_anew_under_its_name_while_the_one_before_is_given_again_stays_in_the_engine() -> None:
    link = SlowEngine(SETTINGS)
    sessions = Sessions(SETTINGS, link, Uploads(link, 0))
    before = sessions._sessions["ab" * 16] = SessionRecord("ab" * 16, {})
    before.revision = 1
    giving = asyncio.create_task(sessions._give_again(before))
    while not link.opened:  # noqa: ASYNC110 - it says nothing
        await asyncio.sleep(0)
    await sessions.close(before, "others needed room")
    anew = sessions._sessions[before.id] = SessionRecord(before.id, {})
    link.let.set()
    with pytest.raises(NotFoundError, match="closed meanwhile"):
        await giving
    assert link.closed == []
    assert sessions.get(before.id) is anew


async def test_who_comes_while_a_session_is_being_made_again_is_told_what_became_of_it() -> None:
    """As the second of two pages of a server that died, which come to the next one by the session's id."""
    link = SlowEngine(SETTINGS)
    sessions = Sessions(SETTINGS, link, Uploads(link, 0))
    link._away_since = -math.inf
    making = asyncio.create_task(sessions.reopen("ab" * 16, {"floor": {}}, {}))
    sessions.taken_over.set()
    while not link.opened:  # noqa: ASYNC110 - it says nothing
        await asyncio.sleep(0)
    viewer = sessions.join(sessions.get("ab" * 16))
    told = [viewer.next_notice(0) for _ in range(3)]
    assert State(revision=0, scene={"floor": {}}, falling=False) in told
    link.let.set()
    session = await making
    notice = viewer.next_notice(1)
    assert notice is not None
    assert (session.state().falling, notice.model_dump()["falling"]) == (True, True)
    assert notice.model_dump()["revision"] == session.revision
