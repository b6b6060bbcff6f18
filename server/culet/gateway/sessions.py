"""The sessions as the gateway knows them: enough to show them to viewers, and to give them to another engine."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import logging
import re
import secrets
import time
from collections import Counter, OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from culet.errors import BusyError, CuletError, EngineUnavailableError, NotFoundError
from culet.gateway.client_address import UNKNOWN
from culet.gateway.link import EngineLink
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads import Uploads, words
from culet.gateway.viewer import DEFAULT_SIZE, Standing, Viewer
from culet_protocol import engine as to_engine
from culet_protocol.engine import SessionMotion, SessionProblem, SessionState
from culet_protocol.frame import Frame
from culet_protocol.messages import BALANCED, Engine, Message, Notice, Problem, SessionEvent, Snapshot, State, Viewers

log = logging.getLogger(__name__)

TICK_SECONDS = 0.25
"""Between looks at what viewers can take, and at sessions that nobody uses."""
REOPENED_AT_ONCE = 4
"""Sessions, in a new engine: some of them need files that are read by processes."""
FAREWELL_SECONDS = 1.0
"""For streams to say why they end."""
SESSION_ID = re.compile(r"[0-9a-f]{32}")
DELETED = "the session was deleted"
DELETED_KEPT = 4096
"""Ids of sessions that were deleted, which nobody can open again."""
SNAPSHOT_BYTES_PER_SECOND = 4000
"""To one viewer. A session of one stone has some 900 bytes, told once a second; larger ones are told more rarely."""
RATE_CHANGE = 0.2
"""A demand that changes by a smaller part is not worth a message."""
DEMAND_SECONDS = 0.25
"""Between two demands of a session: each size is another picture, begun anew."""
UNTOLD = (-1.0, *DEFAULT_SIZE)
"""A demand unlike any, for an engine that may not have heard the last one."""
EVENTS_UNDER_WAY = 8
"""Events of one session that the engine has not answered; more wait with who sent them."""
RELOAD_SECONDS = 10.0
"""A session that was watched so shortly ago makes no room for others: its page is being loaded anew."""
UNUSED_SECONDS = 60.0
"""A session that was left alone for so long makes room for another one of the client that opened it."""


class Session:
    """One session; its truth is in the engine, this is the last that was heard of it."""

    def __init__(self, session: str, scene: dict[str, Any], owner: str = UNKNOWN) -> None:
        self.id = session
        self.owner = owner
        """The client that opened it."""
        self.topic = bytes.fromhex(session)
        self.scene = scene
        self.falling = self.asleep = False
        self.exactness, self.pinned = BALANCED, False
        self.snapshot: dict[str, Any] | None = None
        self.snapshot_told: dict[str, Any] | None = None
        self.next_snapshot_at = -float("inf")
        self.viewers: list[Viewer] = []
        self.latest: tuple[Frame, bytes] | None = None
        self.used = time.monotonic()
        self.watched = False
        """Whether anybody ever watched it, or had a picture of it."""
        self.viewer_left = -float("inf")
        self.viewers_told = 0
        """How many of them the viewers were last told of."""
        self.subscribed = False
        self.demand: tuple[float, int, int] = (0.0, *DEFAULT_SIZE)
        """What the engine was last told."""
        self.demanding: asyncio.Task[None] | None = None
        """Tells the engine, one demand after the other."""
        self.room = asyncio.Semaphore(EVENTS_UNDER_WAY)
        """Held for each event until the engine has answered."""

    def learn(self, described: Mapping[str, Any]) -> None:
        """What the engine said of the session, as it is now."""
        self.scene, self.snapshot = described["scene"], described["snapshot"]
        self.falling, self.asleep = described["falling"], described["asleep"]
        self.exactness, self.pinned = described["exactness"], described["pinned"]

    def tell_snapshot(self, now: float) -> None:
        """Tell the viewers the snapshot, if it is another one and they can do with it now."""
        if self.snapshot is self.snapshot_told or self.snapshot is None or now < self.next_snapshot_at:
            return
        notice = Snapshot(snapshot=self.snapshot)
        size = len(notice.model_dump_json())
        self.snapshot_told, self.next_snapshot_at = self.snapshot, now + max(1.0, size / SNAPSHOT_BYTES_PER_SECOND)
        self.tell(notice)

    def state(self) -> State:
        """The notice for viewers."""
        return State(
            scene=self.scene,
            falling=self.falling,
            asleep=self.asleep,
            exactness=self.exactness,
            pinned=self.pinned,
        )

    def tell(self, notice: Notice) -> None:
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
        self.taken_over = asyncio.Event()
        """Set once this gateway knows the sessions that the engine had when it came."""
        self._deleted: OrderedDict[str, None] = OrderedDict()
        self._viewer_numbers = itertools.count(1)
        link.on_frame = self._on_frame
        link.on_state = self._on_state
        link.on_motion = self._on_motion
        link.on_problem = self._on_problem
        link.on_down = self._on_down
        link.on_up = self._on_up
        uploads.used = self._words

    def __len__(self) -> int:
        return len(self._sessions)

    def __iter__(self) -> Iterator[Session]:
        return iter(self._sessions.values())

    @property
    def viewers(self) -> int:
        """Viewers of all sessions."""
        return sum(len(session.viewers) for session in self._sessions.values())

    def get(self, session: str) -> Session:
        """The session of that id, which thereby counts as used; NotFoundError, or EngineUnavailableError if this
        gateway has just been started and does not know yet."""
        found = self._sessions.get(session)
        if found is None and not self._knows(session):
            raise EngineUnavailableError("the server has just been started; try again in a moment")
        if found is None:
            raise NotFoundError(f"no session {session[:64]!r}; it may have expired")
        found.used = time.monotonic()
        return found

    def _knows(self, session: str) -> bool:
        """Whether it is known if there is such a session."""
        return session in self._sessions or self.taken_over.is_set() or SESSION_ID.fullmatch(session) is None

    async def settle(self, session: str) -> None:
        """Wait until it is known whether there is such a session, but not for long."""
        if self._knows(session):
            return
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(self._settings.engine_start_seconds):
                await self.taken_over.wait()

    async def reopen(
        self, session: str, scene: dict[str, Any], snapshot: dict[str, Any] | None, client: str = UNKNOWN
    ) -> Session:
        """The session of that id, as its viewers say that it was if the server has lost it.

        InputError if they say something that cannot be used, NotFoundError if it was deleted, BusyError at the limit.
        """
        if session in self._deleted:
            raise NotFoundError("that session was deleted")
        await self.settle(session)
        if session in self._sessions:
            return self.get(session)
        return await self.open(scene, client, session, snapshot)

    async def open(
        self,
        scene: dict[str, Any],
        client: str = UNKNOWN,
        name: str | None = None,
        snapshot: dict[str, Any] | None = None,
    ) -> Session:
        """A new session in the engine, which may be starting; BusyError at the client's limit, or that of all."""
        await self._link.until_up()
        session = Session(name or secrets.token_hex(16), scene, client)
        self._sessions[session.id] = session  # before the engine tells its state, and before others count
        try:
            await self._make_room(session)
            opened, _ = await self._uploads.request(
                to_engine.OpenSession(session=session.id, scene=scene, snapshot=snapshot, client=client)
            )
            session.learn(opened)
            if session.id not in self._sessions:
                await self.close(session, "others needed room")
                raise BusyError("others needed the room of this session before it was open; try again")
        except BaseException:
            self._sessions.pop(session.id, None)
            raise
        return session

    async def _make_room(self, new: Session) -> None:
        """Close what others need less than the new session is needed, until all are within the limits; BusyError."""
        while (held := self._of(new.owner)) and len(held) > self._settings.max_client_sessions:
            unused = time.monotonic() - UNUSED_SECONDS
            if not await self._close_one([one for one in held if one is not new and one.used < unused]):
                raise BusyError(f"{new.owner} has {len(held) - 1} sessions open, which is the limit for one client")
        while len(self._sessions) > self._settings.max_sessions:
            owners = Counter(session.owner for session in self._sessions.values())
            richest, most = owners.most_common(1)[0]
            if most <= owners[new.owner] or not await self._close_one(self._of(richest)):
                raise BusyError(f"there are {len(self._sessions) - 1} sessions, which is the limit")

    def _of(self, client: str) -> list[Session]:
        return [session for session in self._sessions.values() if session.owner == client]

    async def _close_one(self, sessions: Sequence[Session]) -> bool:
        """Close the session that is missed least, those never watched first; False if all are being watched."""
        for session in sorted(sessions, key=lambda session: (session.watched, session.used)):
            if session.viewers or time.monotonic() - session.viewer_left < RELOAD_SECONDS:
                continue
            if await self._watched_elsewhere(session) or session.viewers:
                continue
            await self.close(session, "others needed room; open a new session")
            return True
        return False

    async def close(self, session: Session, why: str = DELETED) -> None:
        """Forget a session here and in the engine; its viewers are told."""
        self._sessions.pop(session.id, None)
        if why == DELETED:
            self._deleted[session.id] = None
            while len(self._deleted) > DELETED_KEPT:
                self._deleted.popitem(last=False)
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

    def join(self, session: Session, client: str = UNKNOWN) -> Viewer:
        """A new viewer, told who it is and what it sees; BusyError at the limit."""
        limit, strangers = self._settings.max_viewers, sum(one.client != session.owner for one in session.viewers)
        kept = client != session.owner and strangers >= max(1, limit - 1)
        if kept or len(session.viewers) >= limit:
            raise BusyError(f"{len(session.viewers)} viewers watch this session, which is the limit")
        viewer = Viewer(next(self._viewer_numbers), time.monotonic(), client)
        session.viewers.append(viewer)
        session.watched = True
        viewer.tell(session.state())
        if session.snapshot is not None:
            viewer.tell(Snapshot(snapshot=session.snapshot))
        viewer.tell(Viewers(count=len(session.viewers)))  # the others are told of many that come and go at once
        if not self._link.ready.is_set():
            viewer.tell(Engine(status="down"))
        if session.latest:
            viewer.offer(*session.latest)
        return viewer

    def leave(self, session: Session, viewer: Viewer) -> None:
        """A viewer is gone."""
        session.viewers.remove(viewer)
        session.used = session.viewer_left = time.monotonic()
        self.update_demand(session)

    def update_demand(self, session: Session) -> None:
        """Listen to the session's frames or not, and have the engine told what the viewers can take if it changed."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return
        watched = session.wanted(time.monotonic())[0] > 0
        if watched and not session.subscribed:
            self._link.subscribe(session.topic)
        elif session.subscribed and not watched:
            self._link.unsubscribe(session.topic)
        session.subscribed = watched
        if session.demanding is None or session.demanding.done():
            session.demanding = asyncio.create_task(self._tell_demand(session))

    async def _tell_demand(self, session: Session) -> None:
        """Until nothing has changed: while one demand is under way only the latest of those after it counts."""
        while (demand := self._new_demand(session)) is not None:
            session.demand = demand
            rate, width, height = demand
            try:
                await self._link.request(
                    to_engine.Demand(session=session.id, frames_per_second=rate, width=width, height=height)
                )
            except CuletError as error:
                known = not isinstance(error, NotFoundError)  # or a new engine is about to be given the session
                log.log(logging.WARNING if known else logging.DEBUG, "demand of a session was refused: %s", error)
                session.demand = UNTOLD
                return  # the next tick tries again
            await asyncio.sleep(DEMAND_SECONDS)

    def _new_demand(self, session: Session) -> tuple[float, int, int] | None:
        """What the engine should be told, if it is worth a message."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return None
        demand = rate, *size = session.wanted(time.monotonic())
        told_rate, *told_size = session.demand
        close = (rate > 0) == (told_rate > 0) and abs(rate - told_rate) <= RATE_CHANGE * told_rate
        return None if close and size == told_size else demand

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
                    self.update_demand(session)
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
                unused = not session.viewers and time.monotonic() - session.used > limit
                if unused and self._link.ready.is_set():
                    with contextlib.suppress(CuletError):
                        await self._expire(session)

    async def _expire(self, session: Session) -> None:
        """Close a session, unless somebody watches it straight from the engine, or has come meanwhile."""
        session.used = time.monotonic()  # looked at again only after a while, should it stay
        if not await self._watched_elsewhere(session) and not session.viewers:
            await self.close(session, "nobody used the session")

    async def _watched_elsewhere(self, session: Session) -> bool:
        """Whether somebody watches the session straight from the engine."""
        try:
            described, _ = await self._link.request(to_engine.GetSession(session=session.id))
        except NotFoundError:
            return False
        session.watched = session.watched or described["watched"]
        return bool(described["watched"])

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

    def _on_motion(self, motion: SessionMotion) -> None:
        session = self._sessions.get(motion.session)
        if session and session.snapshot:
            session.snapshot = session.snapshot | motion.moved

    def _on_problem(self, problem: SessionProblem) -> None:
        session = self._sessions.get(problem.session)
        if session:
            session.tell(Problem(code="render_failed", message=f"{problem.title}: {problem.detail}"))

    def _on_down(self) -> None:
        for session in self._sessions.values():
            session.tell(Engine(status="down"))

    async def _on_up(self, new_process: bool) -> None:
        if not self.taken_over.is_set():
            await self._take_over()
        elif new_process:
            watched_first = sorted(self._sessions.values(), key=lambda session: not session.viewers)
            turn = asyncio.Semaphore(REOPENED_AT_ONCE)
            await asyncio.gather(*(self._try_to_reopen(session, turn) for session in watched_first))
        for session in self._sessions.values():
            session.tell(Engine(status="up"))

    async def _take_over(self) -> None:
        """Know the sessions that the engine has: a gateway before this one may have died."""
        answer, _ = await self._link.request(to_engine.ListSessions())
        for described in answer["sessions"]:
            session = Session(described["session"], described["scene"], described["client"] or UNKNOWN)
            session.learn(described)
            session.watched = True  # or so it may have been, and its page may be about to come back
            session.viewer_left = time.monotonic()
            self._sessions.setdefault(session.id, session)
        if answer["sessions"]:
            log.info("took over %d sessions", len(answer["sessions"]))
        self.taken_over.set()

    async def _try_to_reopen(self, session: Session, turn: asyncio.Semaphore) -> None:
        try:
            async with turn:
                await self._reopen(session)
        except CuletError as error:
            session.tell(Problem(code="session_lost", message=f"it could not be opened again: {error}"))
            log.warning("a session could not be opened again: %s", error)

    async def _reopen(self, session: Session) -> None:
        """Give a session, as last heard of, to an engine that does not know it."""
        session.latest = None
        for viewer in session.viewers:
            viewer.restart()
        opened, _ = await self._uploads.request(
            to_engine.OpenSession(
                session=session.id, scene=session.scene, snapshot=session.snapshot, client=session.owner
            )
        )
        session.learn(opened)  # above all the numbers that it goes on with: the next engine must begin beyond them
        session.demand = (0.0, *DEFAULT_SIZE)
        self.update_demand(session)
