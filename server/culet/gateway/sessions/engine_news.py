"""What the engine tells unasked, put into the records of the sessions and told to their viewers."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import replace

from culet.errors import CuletError, EngineUnavailableError
from culet.gateway.engine.link import EngineEvents, EngineLink
from culet.gateway.identity.client_address import UNKNOWN
from culet.gateway.sessions.session_record import SessionRecord
from culet_protocol.engine import GetSession, ListSessions, SessionChange, SessionMotion, SessionProblem
from culet_protocol.frame import Codec, Frame
from culet_protocol.messages import Engine, Problem
from culet_protocol.watch import VIDEO, Lesser

log = logging.getLogger(__name__)


class EngineNews(EngineEvents):
    """Listens to a link."""

    def __init__(
        self,
        link: EngineLink,
        records: dict[str, SessionRecord],
        reopen: Callable[[SessionRecord], Awaitable[None]],
        offered: Callable[[SessionRecord], None],
    ) -> None:
        """`reopen` gives a session to an engine that does not know it; `offered` is called when a frame came."""
        self.taken_over = asyncio.Event()
        """Set once this gateway knows the sessions that the engine had when it came."""
        self._link = link
        self._records = records
        self._catching_up: dict[str, asyncio.Task[None]] = {}
        """By session."""
        self._by_topic: dict[bytes, SessionRecord] = {}
        self._reopen = reopen
        self._offered = offered

    def frame_came(self, frame: Frame, message: bytes) -> None:
        """The session's latest frame."""
        session = self._shown_by(frame.watch)
        if session is None:
            return
        stream = next(codec for codec, topic in session.topics.items() if topic == frame.watch)
        if stream is not Codec.JPEG:  # a viewer knows the session by its watch id alone
            frame, message = replace(frame, watch=session.topic), session.topic + message[len(session.topic) :]
        if not isinstance(stream, Lesser):
            session.latest = None if frame.codec in VIDEO else (frame, message)
        now = time.monotonic()
        session.tiers.came(stream, len(message), now)
        for viewer in session.viewers:
            viewer.offer(frame, message, now, stream)
        self._offered(session)

    def _shown_by(self, topic: bytes) -> SessionRecord | None:
        found = self._by_topic.get(topic)
        if found is None or self._records.get(found.id) is not found:  # sessions came, or went
            self._by_topic = {topic: record for record in self._records.values() for topic in record.topics.values()}
            found = self._by_topic.get(topic)
        return found

    def session_changed(self, change: SessionChange) -> None:
        """Somebody edited the session, or its stones fell asleep or were woken."""
        session = self._records.get(change.session)
        if session is None or session.revision is None:  # it is being opened, and the answer will say all
            return
        told = session.condition
        if change.revision <= session.revision:  # an answer that said so already was faster
            session.tell(session.state())
        elif session.hear(change):
            if change.edited or session.condition != told:
                session.tell(session.state())
        elif session.id not in self._catching_up:  # or else the answer, which comes after this, will say it too
            self._catching_up[session.id] = asyncio.create_task(self._catch_up(session))

    async def _catch_up(self, session: SessionRecord) -> None:
        """Ask for all of a session of which something was missed."""
        try:
            described, _ = await self._link.request(GetSession(session=session.id))
            session.learn(described)
            session.tell(session.state())
        except CuletError:
            pass  # it is gone, or the engine is: then it will be given to the next one
        finally:
            del self._catching_up[session.id]

    def session_moved(self, motion: SessionMotion) -> None:
        """The session's stone moved, or its picture was refined."""
        session = self._records.get(motion.session)
        if session and session.snapshot:
            session.snapshot = session.snapshot | motion.moved

    def session_failed(self, problem: SessionProblem) -> None:
        """What the session shows could not be rendered, or not be moved."""
        session = self._records.get(problem.session)
        if session:
            session.tell(Problem(code="render_failed", message=f"{problem.title}: {problem.detail}"))

    def engine_down(self) -> None:
        """The engine does not answer any more."""
        for session in self._records.values():
            session.tell(Engine(status="down"))

    async def engine_up(self, new_process: bool) -> None:
        """The engine answers again, maybe as another process, which knows nothing of the sessions."""
        if not self.taken_over.is_set():
            await self._take_over()
        elif new_process:
            await self._reopen_all()
            return
        for session in self._records.values():
            session.tell(Engine(status="up"))

    async def _take_over(self) -> None:
        """Know the sessions that the engine has: a gateway before this one may have died."""
        answer, _ = await self._link.request(ListSessions())
        for described in answer["sessions"]:
            session = SessionRecord(described["session"], described["scene"], described["client"] or UNKNOWN)
            session.learn(described)
            session.engine = self._link.instance
            session.watched = True  # or so it may have been, and its page may be about to come back
            session.viewer_left = time.monotonic()
            self._records.setdefault(session.id, session)
        if answer["sessions"]:
            log.info("took over %d sessions", len(answer["sessions"]))
        self.taken_over.set()

    async def _reopen_all(self) -> None:
        """Of each client one session after the other, those that are watched first, and all clients' beside each other:
        an engine makes shapes in turns of clients, so that a client whose shapes take it minutes holds up no other.

        EngineUnavailableError if some could not be given, which then still lack.
        """
        own: dict[str, list[SessionRecord]] = {}
        for session in sorted(self._records.values(), key=lambda session: not session.viewers):
            own.setdefault(session.owner, []).append(session)
        ended = await asyncio.gather(*map(self._reopen_in_turn, own.values()), return_exceptions=True)
        for error in ended:
            if error is not None:
                raise error

    async def _reopen_in_turn(self, sessions: Sequence[SessionRecord]) -> None:
        failed: EngineUnavailableError | None = None
        for session in sessions:
            try:
                await self._try_to_reopen(session)
            except EngineUnavailableError as error:
                failed = error
        if failed is not None:
            raise failed

    async def _try_to_reopen(self, session: SessionRecord) -> None:
        """Its viewers are told as soon as it is there, not only once all others are."""
        opening = session.revision is None  # by who asked for it, who is told if that fails
        if not (opening or session.engine == self._link.instance) and self._is_known(session):
            try:
                await self._reopen(session)
            except EngineUnavailableError:  # it is given when the engine answers again
                raise
            except CuletError as error:
                if self._is_known(session):
                    session.tell(Problem(code="session_lost", message=f"it could not be opened again: {error}"))
                    log.warning("a session could not be opened again: %s", error)
        if self._link.ready.is_set():
            session.tell(Engine(status="up"))

    def _is_known(self, session: SessionRecord) -> bool:
        """Whether it was not closed meanwhile."""
        return self._records.get(session.id) is session
