"""The sessions as the gateway knows them: enough to show them to viewers, and to give them to another engine."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import logging
import secrets
import time
from typing import Any

from culet.errors import BusyError, CuletError, NotFoundError
from culet.gateway.link import EngineLink
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads import Uploads, words
from culet.gateway.viewer import DEFAULT_SIZE, Viewer
from culet_protocol import engine as to_engine
from culet_protocol.engine import SessionProblem, SessionState
from culet_protocol.frame import Frame
from culet_protocol.messages import BALANCED, Engine, Message, Problem, SessionEvent, State, Viewers

log = logging.getLogger(__name__)

TICK_SECONDS = 0.25
"""Between looks at what viewers can take, and at sessions that nobody uses."""
RATE_CHANGE = 0.2
"""A demand that changes by a smaller part is not worth a message."""


class Session:
    """One session; its truth is in the engine, this is the last that was heard of it."""

    def __init__(self, session: str, scene: dict[str, Any]) -> None:
        self.id = session
        self.topic = bytes.fromhex(session)
        self.scene = scene
        self.falling = self.asleep = False
        self.exactness, self.pinned = BALANCED, False
        self.snapshot: dict[str, Any] | None = None
        self.viewers: list[Viewer] = []
        self.latest: tuple[Frame, bytes] | None = None
        self.used = time.monotonic()
        self.subscribed = False
        self.demand: tuple[float, int, int] = (0.0, *DEFAULT_SIZE)

    def state(self) -> State:
        """The notice for viewers."""
        return State(
            scene=self.scene,
            falling=self.falling,
            asleep=self.asleep,
            exactness=self.exactness,
            pinned=self.pinned,
        )

    def tell(self, notice: Message) -> None:
        """Tell every viewer."""
        for viewer in self.viewers:
            viewer.tell(notice)

    def wanted(self, now: float) -> tuple[float, int, int]:
        """Frames per second that some viewer can take, and the size that the one who has watched longest asked for."""
        watching = [viewer for viewer in self.viewers if viewer.watches(now)]
        rate = max((viewer.rate(now) for viewer in watching), default=0.0)
        sized = [viewer for viewer in watching if viewer.size]
        size = min(sized, key=lambda viewer: viewer.watching_since).size if sized else None
        return (rate, *(size or (self.demand[1:] if watching else DEFAULT_SIZE)))


class Sessions:
    """All sessions of this gateway."""

    def __init__(self, settings: GatewaySettings, link: EngineLink, uploads: Uploads) -> None:
        self._settings = settings
        self._link = link
        self._uploads = uploads
        self._sessions: dict[str, Session] = {}
        self._viewer_numbers = itertools.count(1)
        link.on_frame = self._on_frame
        link.on_state = self._on_state
        link.on_problem = self._on_problem
        link.on_down = self._on_down
        link.on_up = self._on_up
        uploads.used = self._words

    def __len__(self) -> int:
        return len(self._sessions)

    @property
    def viewers(self) -> int:
        """Viewers of all sessions."""
        return sum(len(session.viewers) for session in self._sessions.values())

    def get(self, session: str) -> Session:
        """The session of that id, which thereby counts as used; NotFoundError."""
        found = self._sessions.get(session)
        if found is None:
            raise NotFoundError(f"no session {session[:64]!r}; it may have expired")
        found.used = time.monotonic()
        return found

    async def open(self, scene: dict[str, Any]) -> Session:
        """A new session in the engine; BusyError at the limit."""
        if len(self._sessions) >= self._settings.max_sessions:
            raise BusyError(f"there are {len(self._sessions)} sessions, which is the limit")
        session = Session(secrets.token_hex(16), scene)
        self._sessions[session.id] = session  # before the engine tells its state
        try:
            await self._uploads.request(to_engine.OpenSession(session=session.id, scene=scene))
        except BaseException:
            self._sessions.pop(session.id, None)
            raise
        return session

    async def close(self, session: Session, why: str = "the session was deleted") -> None:
        """Forget a session here and in the engine; its viewers are told."""
        self._sessions.pop(session.id, None)
        session.tell(Problem(code="session_closed", message=why))
        for viewer in session.viewers:
            viewer.dismiss()
        if session.subscribed:
            self._link.unsubscribe(session.topic)
            session.subscribed = False
        with contextlib.suppress(NotFoundError):
            await self._link.request(to_engine.CloseSession(session=session.id))

    async def apply(self, session: Session, event: SessionEvent) -> dict[str, Any]:
        """Have the engine apply an event."""
        return await self._ask(session, to_engine.Control(session=session.id, event=event))

    async def describe(self, session: Session) -> dict[str, Any]:
        """What the engine says of the session now."""
        described = await self._ask(session, to_engine.GetSession(session=session.id))
        session.scene = described.get("scene", session.scene)
        return described

    def join(self, session: Session) -> Viewer:
        """A new viewer, told who it is and what it sees; BusyError at the limit."""
        if len(session.viewers) >= self._settings.max_viewers:
            raise BusyError(f"{len(session.viewers)} viewers watch this session, which is the limit")
        viewer = Viewer(next(self._viewer_numbers), time.monotonic())
        session.viewers.append(viewer)
        viewer.tell(session.state())
        session.tell(Viewers(count=len(session.viewers)))
        if not self._link.ready.is_set():
            viewer.tell(Engine(status="down"))
        if session.latest:
            viewer.offer(*session.latest)
        return viewer

    async def leave(self, session: Session, viewer: Viewer) -> None:
        """A viewer is gone."""
        session.viewers.remove(viewer)
        session.used = time.monotonic()
        session.tell(Viewers(count=len(session.viewers)))
        await self.update_demand(session)

    async def update_demand(self, session: Session) -> None:
        """Tell the engine what the viewers can take, if that has changed, and listen to its frames or not."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return
        rate, width, height = session.wanted(time.monotonic())
        if (rate > 0) != session.subscribed:
            session.subscribed = rate > 0
            (self._link.subscribe if session.subscribed else self._link.unsubscribe)(session.topic)
        told_rate, *told_size = session.demand
        close = (rate > 0) == (told_rate > 0) and abs(rate - told_rate) <= RATE_CHANGE * told_rate
        if close and [width, height] == told_size:
            return
        session.demand = (rate, width, height)
        try:
            await self._link.request(
                to_engine.Demand(session=session.id, frames_per_second=rate, width=width, height=height)
            )
        except CuletError as error:
            log.warning("demand of a session was refused: %s", error)

    async def run(self) -> None:
        """Follow what viewers can take, and forget sessions that nobody uses, until cancelled."""
        while True:
            await asyncio.sleep(TICK_SECONDS)
            now = time.monotonic()
            for session in list(self._sessions.values()):
                if session.viewers:
                    session.used = now
                    await self.update_demand(session)
                elif now - session.used > self._settings.session_idle_seconds and self._link.ready.is_set():
                    with contextlib.suppress(CuletError):
                        await self._expire(session)

    async def _expire(self, session: Session) -> None:
        """Close a session, unless somebody watches it straight from the engine."""
        session.used = time.monotonic()  # looked at again only after a while, should it stay
        with contextlib.suppress(NotFoundError):
            described, _ = await self._link.request(to_engine.GetSession(session=session.id))
            if described["watched"]:
                return
        await self.close(session, "nobody used the session")

    async def _ask(self, session: Session, message: Message) -> dict[str, Any]:
        """A request about a session; one that the engine does not know, because it is new, is opened there first."""
        try:
            result, _ = await self._uploads.request(message, session.scene)
        except NotFoundError:
            if session.id not in self._sessions:
                raise
            await self._reopen(session)
            result, _ = await self._uploads.request(message, session.scene)
        return result

    def _words(self) -> set[str]:
        return words([(session.scene, session.snapshot) for session in self._sessions.values()])

    def _on_frame(self, frame: Frame, message: bytes) -> None:
        session = self._sessions.get(frame.session.hex())
        if session is None:
            return
        session.latest = (frame, message)
        for viewer in session.viewers:
            viewer.offer(frame, message)

    def _on_state(self, state: SessionState) -> None:
        session = self._sessions.get(state.session)
        if session is None:
            return
        session.scene, session.falling, session.snapshot = state.scene, state.falling, state.snapshot
        session.exactness, session.pinned = state.exactness, state.pinned
        told_asleep, session.asleep = session.asleep, state.asleep
        if state.edited or session.asleep != told_asleep:
            session.tell(session.state())

    def _on_problem(self, problem: SessionProblem) -> None:
        session = self._sessions.get(problem.session)
        if session:
            session.tell(Problem(code="render_failed", message=f"{problem.title}: {problem.detail}"))

    def _on_down(self) -> None:
        for session in self._sessions.values():
            session.tell(Engine(status="down"))

    async def _on_up(self, new_process: bool) -> None:
        if new_process:
            for session in list(self._sessions.values()):
                try:
                    await self._reopen(session)
                except CuletError as error:
                    session.tell(Problem(code="session_lost", message=f"it could not be opened again: {error}"))
        for session in self._sessions.values():
            session.tell(Engine(status="up"))

    async def _reopen(self, session: Session) -> None:
        """Give a session, as last heard of, to an engine that does not know it."""
        session.latest = None
        for viewer in session.viewers:
            viewer.restart()
        await self._uploads.request(
            to_engine.OpenSession(session=session.id, scene=session.scene, snapshot=session.snapshot)
        )
        session.demand = (0.0, *DEFAULT_SIZE)
        await self.update_demand(session)
