"""The sessions as the gateway knows them: enough to show them to viewers, and to give them to another engine."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import re
import secrets
import time
from collections import OrderedDict
from collections.abc import Iterator
from functools import partial
from typing import Any

from culet.errors import BusyError, CuletError, EngineUnavailableError, ForbiddenError, NotFoundError
from culet.gateway.engine.link import EngineLink
from culet.gateway.identity.client_address import UNKNOWN
from culet.gateway.operation.drain import Drain
from culet.gateway.sessions.demands import Demands
from culet.gateway.sessions.engine_news import EngineNews
from culet.gateway.sessions.session_places import RELOAD_SECONDS, SessionPlaces
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads.uploads import Uploads, words
from culet.gateway.viewers.viewer import Standing, Viewer
from culet_protocol import engine as to_engine
from culet_protocol.messages import (
    Answer,
    Engine,
    Leaving,
    Message,
    Problem,
    Question,
    SessionEvent,
    Snapshot,
    Viewers,
    answer,
)

TICK_SECONDS = 0.25
"""Between looks at what viewers can take, and at sessions that nobody uses."""
FAREWELL_SECONDS = 1.0
"""For streams to say why they end."""
SESSION_ID = re.compile(r"[0-9a-f]{32}")
DELETED = "the session was deleted"
DELETED_KEPT = 4096
"""Ids of sessions that were deleted, which nobody can open again."""


class Sessions:
    """All sessions of this gateway."""

    def __init__(self, settings: GatewaySettings, link: EngineLink, uploads: Uploads) -> None:
        self._settings = settings
        self._link = link
        self._uploads = uploads
        self._sessions: dict[str, SessionRecord] = {}
        self._demands = Demands(link, self._sessions)
        self._places = SessionPlaces(settings, self._sessions, self.close, self._watched_elsewhere)
        self._news = link.events = EngineNews(link, self._sessions, self._give_again, self._demands.heed_video)
        self._giving: dict[SessionRecord, asyncio.Task[None]] = {}
        """Sessions that the engine is being given again."""
        self._deleted: OrderedDict[str, None] = OrderedDict()
        self._viewer_numbers = itertools.count(1)
        self.drain = Drain()
        """Once begun there are no new sessions."""
        uploads.used = self._words

    @property
    def taken_over(self) -> asyncio.Event:
        """Set once this gateway knows the sessions that the engine had when it came."""
        return self._news.taken_over

    def __len__(self) -> int:
        return len(self._sessions)

    def __contains__(self, session: str) -> bool:
        return session in self._sessions

    def __iter__(self) -> Iterator[SessionRecord]:
        return iter(self._sessions.values())

    @property
    def viewers(self) -> int:
        """Viewers of all sessions."""
        return sum(len(session.viewers) for session in self._sessions.values())

    def steered(self, session: str) -> SessionRecord:
        """As `get`, for somebody who is about to change the session; ForbiddenError if the id is a watch id."""
        found = self.get(session)
        if found.id != session:
            raise ForbiddenError("this link lets watch the session; whoever has its other link changes it")
        return found

    def takes_files(self, session: str) -> None:
        """Whether files may be given for the session of that id, which thereby counts as used: also for one that is
        lost, and about to be made again. ForbiddenError for a watch id, NotFoundError for what there cannot be."""
        if session in self._deleted or SESSION_ID.fullmatch(session) is None:
            raise NotFoundError(f"no session {session[:64]!r}")
        if session in self._sessions or self._watched_by(session) is not None:
            self.steered(session)

    def _watched_by(self, watch: str) -> SessionRecord | None:
        """The session of that watch id."""
        return next((session for session in self._sessions.values() if session.topic.hex() == watch), None)

    def get(self, session: str) -> SessionRecord:
        """The session of that id or watch id, which thereby counts as used; NotFoundError, or EngineUnavailableError if
        this gateway has just been started and does not know yet."""
        found = self._sessions.get(session) or self._watched_by(session)
        if found is None and not self._knows(session):
            raise EngineUnavailableError("the server has just been started; try again in a moment")
        if found is None:
            raise NotFoundError(f"no session {session[:64]!r}; it may have expired")
        found.used = time.monotonic()
        return found

    def _knows(self, session: str) -> bool:
        """Whether it is known if there is such a session."""
        return (
            session in self._sessions
            or self._watched_by(session) is not None
            or self._news.taken_over.is_set()
            or SESSION_ID.fullmatch(session) is None
        )

    async def settle(self, session: str) -> None:
        """Wait until it is known whether there is such a session, but not for long."""
        if self._knows(session):
            return
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(self._settings.engine_start_seconds):
                await self._news.taken_over.wait()

    async def reopen(
        self, session: str, scene: dict[str, Any], snapshot: dict[str, Any] | None, client: str = UNKNOWN
    ) -> SessionRecord:
        """The session of that id, as its viewers say that it was if the server has lost it.

        InputError if they say something that cannot be used, NotFoundError if it was deleted, BusyError at the limit.
        """
        if session in self._deleted:
            raise NotFoundError("that session was deleted")
        await self.settle(session)
        if session in self._sessions:
            return self.get(session)
        if self._watched_by(session) is not None:
            raise ForbiddenError("that is a watch id: the session that it lets watch is there")
        return await self.open(scene, client, session, snapshot)

    async def open(
        self,
        scene: dict[str, Any],
        client: str = UNKNOWN,
        name: str | None = None,
        snapshot: dict[str, Any] | None = None,
    ) -> SessionRecord:
        """A new session in the engine, which may be starting; BusyError at the client's limit, or that of all,
        LeavingError if the server is about to be stopped."""
        self.drain.admit()
        await self._link.until_up()
        session = SessionRecord(name or secrets.token_hex(16), scene, client)
        self._sessions[session.id] = session  # before the engine tells its state, and before others count
        try:
            await self._places.make_room(session)
            opened, _ = await self._uploads.request(
                to_engine.OpenSession(session=session.id, scene=scene, snapshot=snapshot, client=client),
                for_asker=True,  # also one that its client says there was: it may say so of as many as it likes
            )
            session.learn(opened)
            session.engine = self._link.instance
            if session.id not in self._sessions:
                await self.close(session, "others needed room")
                raise BusyError("others needed the room of this session before it was open; try again")
            session.tell(session.state())  # to who came by its id while the engine made it
        except BaseException:
            self._sessions.pop(session.id, None)
            raise
        return session

    async def close(self, session: SessionRecord, why: str = DELETED) -> None:
        """Forget a session here and in the engine; its viewers are told."""
        self._sessions.pop(session.id, None)
        if why == DELETED:
            self._deleted[session.id] = None
            while len(self._deleted) > DELETED_KEPT:
                self._deleted.popitem(last=False)
        session.tell(Problem(code="session_closed", message=why))
        for viewer in session.viewers:
            viewer.dismiss()
        self._demands.forget(session)
        with contextlib.suppress(NotFoundError):
            await self._link.request(to_engine.CloseSession(session=session.id))

    async def apply(self, session: SessionRecord, event: SessionEvent) -> dict[str, Any]:
        """Have the engine apply an event."""
        return await self._ask(session, to_engine.Control(session=session.id, event=event))

    async def ask(self, session: SessionRecord, question: Question) -> Answer:
        """What the engine answers to a question about the session's picture."""
        asked = to_engine.Ask(session=session.id, question=question)
        result, _ = await self.request(session, asked, for_asker=True)
        return answer.validate_python(result)

    async def scene_shown(self, session: SessionRecord, step: int | None) -> dict[str, Any]:
        """The scene that a session showed at a step, the latest if None; raises like `request`."""
        scene: dict[str, Any] = (await self._ask(session, to_engine.GetScene(session=session.id, step=step)))["scene"]
        return scene

    async def request(
        self, session: SessionRecord, message: Message, *, patient: bool = False, for_asker: bool = False
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        """As `Uploads.request`, about a session; one that the engine does not know, because it is new, is opened there
        first."""
        with session.awaited():
            try:
                return await self._uploads.request(message, session.scene, patient=patient, for_asker=for_asker)
            except NotFoundError:
                if session.id not in self._sessions:
                    raise
                if not await self._in_engine(session):  # or a step of it is not kept, which is no loss to its viewers
                    await self._until_given_again(session, patient=patient)
                return await self._uploads.request(message, session.scene, patient=patient, for_asker=for_asker)

    async def describe(self, session: SessionRecord) -> dict[str, Any]:
        """What the engine says of the session now."""
        described = await self._ask(session, to_engine.GetSession(session=session.id))
        session.learn(described)
        return described

    async def farewell(self) -> None:
        """End all streams, since the server stops; returns when they have ended, or did not in time."""
        for session in self._sessions.values():
            for viewer in session.viewers:
                viewer.dismiss(Standing.STOPPING)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(FAREWELL_SECONDS):
                while self.viewers:  # noqa: ASYNC110 - each leaves by itself
                    await asyncio.sleep(0.01)

    async def in_use(self) -> bool:
        """Whether anybody watches a session, or may be about to come back to one."""
        lately = time.monotonic() - RELOAD_SECONDS
        if any(session.viewers or session.used > lately for session in self._sessions.values()):
            return True
        with contextlib.suppress(CuletError):  # an engine that cannot tell keeps no server from its end
            for session in list(self._sessions.values()):
                if await self._watched_elsewhere(session):
                    return True
        return False

    def warn(self) -> None:
        """Tell all viewers that the server is about to be stopped."""
        for session in self._sessions.values():
            session.tell(Leaving(seconds=self.drain.left))

    def join(self, session: SessionRecord, client: str = UNKNOWN, *, steers: bool = True) -> Viewer:
        """A new viewer, who steers or only watches, told who it is and what it sees; BusyError at the limit."""
        limit, strangers = self._settings.max_viewers, sum(one.client != session.owner for one in session.viewers)
        kept = client != session.owner and strangers >= max(1, limit - 1)
        if kept or len(session.viewers) >= limit:
            raise BusyError(f"{len(session.viewers)} viewers watch this session, which is the limit")
        viewer = Viewer(next(self._viewer_numbers), time.monotonic(), client, steers=steers)
        session.viewers.append(viewer)
        session.watched = True
        viewer.tell(session.state())
        if session.snapshot is not None and steers:
            viewer.tell(Snapshot(snapshot=session.snapshot))
        viewer.tell(Viewers(count=len(session.viewers)))  # the others are told of many that come and go at once
        if not self._link.ready.is_set():
            viewer.tell(Engine(status="down"))
        if self.drain.begun.is_set():
            viewer.tell(Leaving(seconds=self.drain.left))
        if session.latest:
            viewer.offer(*session.latest, time.monotonic())
        return viewer

    def update_demand(self, session: SessionRecord) -> None:
        """A viewer can take something else than before: the engine is told, if that changes what it should do."""
        self._demands.update(session)

    def video_taken(self, session: SessionRecord) -> None:
        """A viewer has taken a frame, or decodes something else than before."""
        self._demands.heed_video(session)

    def leave(self, session: SessionRecord, viewer: Viewer) -> None:
        """A viewer is gone."""
        session.viewers.remove(viewer)
        session.used = session.viewer_left = time.monotonic()
        self._demands.update(session)

    async def run(self) -> None:
        """Follow what viewers can take, and forget sessions that nobody uses, until cancelled."""
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._follow_viewers())
            tasks.create_task(self._forget_unused())

    async def _follow_viewers(self) -> None:
        while True:
            await asyncio.sleep(TICK_SECONDS)
            for session in self._sessions.values():
                if session.viewers:
                    session.used = time.monotonic()
                    self._demands.update(session)
                    self._demands.heed_video(session)  # while the engine holds, no frame comes that could lead to it
                    session.tell_snapshot(time.monotonic())
                if session.viewers_told != len(session.viewers):
                    session.viewers_told = len(session.viewers)
                    session.tell(Viewers(count=session.viewers_told))

    async def _forget_unused(self) -> None:
        while True:
            await asyncio.sleep(TICK_SECONDS)
            for session in list(self._sessions.values()):
                limit = self._settings.session_idle_seconds
                if not session.watched:
                    limit = min(limit, self._settings.unwatched_session_seconds)
                needed = session.viewers or session.asked
                unused = not needed and time.monotonic() - session.used > limit
                if unused and self._link.ready.is_set():
                    with contextlib.suppress(CuletError):
                        await self._expire(session)

    async def _expire(self, session: SessionRecord) -> None:
        """Close a session, unless somebody watches it straight from the engine, or has come meanwhile."""
        session.used = looked = time.monotonic()  # looked at again only after a while, should it stay
        watched = await self._watched_elsewhere(session)
        if not (watched or session.viewers or session.asked) and session.used == looked:
            await self.close(session, "nobody used the session")

    async def _watched_elsewhere(self, session: SessionRecord) -> bool:
        """Whether somebody watches the session straight from the engine."""
        try:
            described, _ = await self._link.request(to_engine.GetSession(session=session.id))
        except NotFoundError:
            return False
        session.watched = session.watched or described["watched"]
        return bool(described["watched"])

    async def _ask(self, session: SessionRecord, message: Message) -> dict[str, Any]:
        result, _ = await self.request(session, message)
        return result

    async def _in_engine(self, session: SessionRecord) -> bool:
        """Whether the engine knows the session."""
        try:
            await self._link.request(to_engine.GetSession(session=session.id))
        except NotFoundError:
            return False
        return True

    def _words(self) -> set[str]:
        return words([(session.scene, session.snapshot) for session in self._sessions.values()])

    async def _until_given_again(self, session: SessionRecord, *, patient: bool) -> None:
        """As `_give_again`, for who does not wait for ever; EngineUnavailableError if it takes long."""
        try:
            async with asyncio.timeout(None if patient else self._settings.request_seconds):
                await self._give_again(session)
        except TimeoutError:
            raise EngineUnavailableError("this session is still being made again; try again later") from None

    async def _give_again(self, session: SessionRecord) -> None:
        """Give a session, as last heard of, to an engine that does not know it: however long that takes, and once for
        all who wait for it. One that nobody has seen yet is given up with who asks for it."""
        if session.revision is None:
            await self._give(session, patient=False)
            return
        giving = self._giving.get(session)
        if giving is None:
            giving = self._giving[session] = asyncio.create_task(self._give(session, patient=True))
            giving.add_done_callback(partial(self._given, session))
        await asyncio.shield(giving)

    def _given(self, session: SessionRecord, giving: asyncio.Task[None]) -> None:
        del self._giving[session]
        if not giving.cancelled():
            giving.exception()  # which maybe nobody waits for any more

    async def _give(self, session: SessionRecord, *, patient: bool) -> None:
        """NotFoundError if the session is closed by then, or meanwhile."""
        self._check_known(session)
        session.latest = None
        for viewer in session.viewers:
            viewer.restart()
        opened, _ = await self._uploads.request(
            to_engine.OpenSession(
                session=session.id, scene=session.scene, snapshot=session.snapshot, client=session.owner
            ),
            patient=patient,
            for_asker=not patient,
        )
        session.engine = self._link.instance
        if session.id not in self._sessions:  # the engine did not have it yet when it was closed
            with contextlib.suppress(NotFoundError):
                await self._link.request(to_engine.CloseSession(session=session.id))
        self._check_known(session)
        session.learn(opened)  # above all the numbers that it goes on with: the next engine must begin beyond them
        self._demands.begin_anew(session)

    def _check_known(self, session: SessionRecord) -> None:
        if self._sessions.get(session.id) is not session:
            raise NotFoundError("that session was closed meanwhile")
