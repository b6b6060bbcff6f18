"""What a gateway makes of what an engine says unasked, and of what it missed."""

from __future__ import annotations

import asyncio
from typing import Any

from culet.engine.session.session import Session
from culet.gateway.engine.link import EngineLink
from culet.gateway.sessions.engine_news import OF_ONE_CLIENT, EngineNews
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.settings import GatewaySettings
from culet.gateway.viewers.viewer import Viewer
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.engine import SessionChange
from culet_protocol.messages import Engine, Message, Notice, State

NAME = "5" * 32


class HeldLink(EngineLink):
    """Answers when it is let, with what the session is like then."""

    def __init__(self, session: Session) -> None:
        super().__init__(GatewaySettings(control="tcp://127.0.0.1:1", frames="tcp://127.0.0.1:1"))
        self.requests = 0
        self.let = asyncio.Event()
        self._session = session

    async def request(
        self,
        message: Message,
        payload: bytes | bytearray | None = None,
        *,
        patient: bool = False,
        for_asker: bool = False,
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        self.requests += 1
        await self.let.wait()
        return described(self._session), b""


def described(session: Session) -> dict[str, Any]:
    return session.described() | {"findings": []}


async def nobody_reopens(_: SessionRecord) -> None:
    raise AssertionError


class Listener(Viewer):
    """Keeps what it is told."""

    def __init__(self) -> None:
        super().__init__(1, 0.0)
        self.exposures: list[float] = []
        self.engines: list[str] = []

    def tell(self, notice: Notice) -> None:
        if isinstance(notice, Engine):
            self.engines.append(notice.status)
            return
        assert isinstance(notice, State)
        self.exposures.append(notice.scene["film"]["exposure"])


def edited(session: Session, exposure: float) -> SessionChange:
    film = session.scene.film.model_copy(update={"exposure": exposure})
    session.change(session.stage.showing(session.scene.model_copy(update={"film": film})))
    return session.change_told(edited=True)


def watched(session: Session) -> tuple[HeldLink, SessionRecord, EngineNews, Listener]:
    link = HeldLink(session)
    record = SessionRecord(session.name, {})
    record.learn(described(session))
    viewer = Listener()
    record.viewers.append(viewer)
    return link, record, EngineNews(link, {session.name: record}, nobody_reopens, lambda _: None), viewer


async def turns() -> None:
    for _ in range(10):
        await asyncio.sleep(0)


async def test_of_a_session_of_which_something_was_missed_all_is_asked_for_once_however_much_comes_meanwhile() -> None:
    session = Session(NAME, Stage.of(Scene()))
    link, record, news, viewer = watched(session)
    edited(session, 5.0)  # this one is lost
    for number in range(100):
        news.session_changed(edited(session, (number + 1) / 100))
    await turns()
    assert link.requests == 1
    link.let.set()
    await turns()
    assert record.scene == session.scene.model_dump(mode="json")
    assert viewer.exposures == [1.0]
    news.session_changed(edited(session, 2.0))
    edited(session, 3.0)  # lost again
    news.session_changed(edited(session, 4.0))
    await turns()
    assert link.requests == 2
    assert viewer.exposures == [1.0, 2.0, 4.0]


async def test_a_change_that_an_answer_told_already_is_told_to_viewers_and_nothing_is_asked() -> None:
    session = Session(NAME, Stage.of(Scene()))
    link, record, news, viewer = watched(session)
    change = edited(session, 1.5)
    record.learn(described(session))
    news.session_changed(change)
    await turns()
    assert link.requests == 0
    assert viewer.exposures == [1.5]


async def test_sessions_of_a_client_whose_shapes_take_long_hold_up_no_others_when_an_engine_is_new() -> None:
    heavy = [SessionRecord(f"{number:032x}", {}, "10.0.0.1") for number in range(8)]
    light = [SessionRecord(f"{number:032x}", {}, "10.0.0.2") for number in range(8, 12)]
    viewers = {record.id: Listener() for record in (*heavy, *light)}
    records = {record.id: record for record in (*heavy, *light)}
    for record in records.values():
        record.viewers.append(viewers[record.id])
    go_on, asked = asyncio.Event(), list[str]()

    async def reopen(record: SessionRecord) -> None:
        asked.append(record.id)
        if record.owner == "10.0.0.1":
            await go_on.wait()

    link = HeldLink(Session(NAME, Stage.of(Scene())))
    link.ready.set()
    news = EngineNews(link, records, reopen, lambda _: None)
    news.taken_over.set()
    coming = asyncio.create_task(news.engine_up(True))
    for _ in range(100):
        await asyncio.sleep(0)
    assert sorted(asked) == [record.id for record in (*heavy[:OF_ONE_CLIENT], *light)]
    assert [viewers[record.id].engines for record in light] == [["up"]] * 4, "told without waiting for the others"
    assert all(not viewers[record.id].engines for record in heavy)
    go_on.set()
    await coming
    assert [viewer.engines for viewer in viewers.values()] == [["up"]] * 12
