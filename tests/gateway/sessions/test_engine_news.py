"""What a gateway makes of what an engine says unasked, and of what it missed."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from culet.engine.session.session import Session
from culet.errors import EngineUnavailableError
from culet.gateway.engine.link import EngineLink
from culet.gateway.sessions.engine_news import EngineNews
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.settings import GatewaySettings
from culet.gateway.viewers.viewer import Viewer
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.engine import SessionChange
from culet_protocol.messages import Engine, Message, Notice, State
from shared.patience import PATIENCE

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


class Reopening:
    """A gateway that has sessions, and an engine that opens those of some clients only once it is let."""

    def __init__(self, *, light: int, heavy: int, of_heavy: int = 0) -> None:
        """So many clients with a session each, and clients with so many sessions each whose shapes take long."""
        owners = [f"light {number}" for number in range(light)]
        owners += [f"heavy {number // of_heavy}" for number in range(heavy * of_heavy)]
        self.records = {
            f"{number:032x}": SessionRecord(f"{number:032x}", {}, name) for number, name in enumerate(owners)
        }
        self.viewers: dict[str, Listener] = {}
        for record in self.records.values():
            record.revision, record.engine = 1, "1"
            self.viewers[record.id] = Listener()
            record.viewers.append(self.viewers[record.id])
        self.go_on = asyncio.Event()
        self.asked: list[str] = []
        self.link = HeldLink(Session(NAME, Stage.of(Scene())))
        self.link.events = self.news = EngineNews(self.link, self.records, self.reopen, lambda _: None)
        self.news.taken_over.set()
        self.link._greeted = "1"

    async def reopen(self, record: SessionRecord) -> None:
        """As the sessions' own."""
        self.asked.append(record.id)
        instance = self.link.instance
        if record.owner.startswith("heavy"):
            await self.go_on.wait()
        if self.link.instance != instance or not self.link.ready.is_set():
            raise EngineUnavailableError("it went")
        record.engine = instance

    async def greeted(self) -> None:
        """Until the engine that was heard last has what it lacked."""
        greeting = self.link._greeting
        assert greeting is not None
        async with asyncio.timeout(PATIENCE):
            await greeting


async def test_sessions_of_clients_whose_shapes_take_long_hold_up_no_others_when_an_engine_is_new() -> None:
    heavy, each = 5, 8
    gateway = Reopening(light=12, heavy=heavy, of_heavy=each)
    light = [name for name, record in gateway.records.items() if record.owner.startswith("light")]
    slow = [name for name in gateway.records if name not in light]
    gateway.link._hear("2")
    await turns()
    assert sorted(gateway.asked) == sorted([*light, *slow[::each]]), "of each client one at a time"
    assert all(gateway.viewers[name].engines == ["up"] for name in light), "told without waiting for the others"
    assert not any(gateway.viewers[name].engines for name in slow)
    gateway.go_on.set()
    await gateway.greeted()
    assert sorted(gateway.asked) == sorted(gateway.records)
    assert all(viewer.engines == ["up"] for viewer in gateway.viewers.values())


async def test_sessions_that_wait_when_the_link_breaks_are_given_when_the_same_engine_is_heard_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("culet.gateway.engine.link.GREET_AGAIN_SECONDS", 0)
    gateway = Reopening(light=1, heavy=1, of_heavy=2)
    done, *waiting = gateway.records
    gateway.link._hear("2")
    await turns()
    assert gateway.asked == [done, waiting[0]]
    gateway.link.lose("the cable was pulled")
    gateway.go_on.set()
    await gateway.greeted()
    assert [record.engine for record in gateway.records.values()] == ["2", "1", "1"]
    assert all(gateway.viewers[name].engines == ["down"] for name in waiting), "they are not told that it has them"
    gateway.asked.clear()
    gateway.link._hear("2")
    await gateway.greeted()
    assert gateway.asked == waiting, "and nothing that the engine has"
    assert {record.engine for record in gateway.records.values()} == {"2"}
    assert all(gateway.viewers[name].engines == ["down", "up"] for name in waiting)


async def test_a_session_that_is_closed_opened_or_given_while_it_waits_for_its_turn_is_not_given_then() -> None:
    gateway = Reopening(light=0, heavy=1, of_heavy=5)
    first, closed, given, opening, last = gateway.records.values()
    gateway.link._hear("2")
    await turns()
    del gateway.records[closed.id]
    given.engine = "2"  # by an event
    opening.revision = None  # asked for by a page that waits for the answer
    gateway.go_on.set()
    await gateway.greeted()
    assert gateway.asked == [first.id, last.id]
