"""The sessions of this engine, each with its live picture: opened, found, watched, and closed."""

from __future__ import annotations

import asyncio
import math
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.memory import Memory
from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.painter import Painter
from culet.engine.process.staging import CHANGE_SECONDS, Patience, Staging
from culet.engine.session import events
from culet.engine.session.history import History
from culet.engine.session.session import Session
from culet.engine.session.snapshot import SessionSnapshot
from culet.errors import BusyError, NotFoundError
from culet.scene import Environment, Scene
from culet.simulation.overlaps import overlaps
from culet.stage import Library, Stage
from culet_protocol.engine import OpenSession
from culet_protocol.watch import STREAMS, topic_of

SUBSCRIPTIONS = 4096
"""Subscriptions that are remembered: sessions may be opened after somebody subscribed to them."""
SESSION_BYTES = 2**20
"""Of a session: its scene, its simulation with the stone's hull, and its stone if that is a cut."""
AT_REST_SECONDS = 2.0
"""Without a frame of video, after which a session's encoders are given back where memory is needed."""
HISTORY_SHARE = 1 / 8
"""Of the memory that all histories together may take."""


GONE = "no such session; it may have expired"


class OpenSessions:
    """Mutable. A session is told apart by its name."""

    def __init__(self, painter: Painter, limits: Limits, memory: Memory, staging: Staging) -> None:
        """Their pictures are the painter's."""
        self.simulated_seconds = self.dropped_seconds = 0.0
        """Of sessions that are closed: seconds that were to be simulated, and of these those that were dropped."""
        self._painter = painter
        self._limits = limits
        self._memory = memory
        self._staging = staging
        self._history = partial(History, limits.max_shown_states, HISTORY_SHARE * memory.budget / limits.max_sessions)
        self._touched: dict[str, float] = {}
        """s, steady clock: when somebody last asked for each."""
        self._clients: dict[str, str] = {}
        """Who opened the sessions."""
        self._opening: dict[str, set[threading.Event]] = {}
        """Set of sessions that were closed before they were open."""
        self._subscriptions: set[bytes] = set()
        memory.count("histories", lambda: sum(live.session.history.nbytes for live in self))
        memory.count("video", lambda: sum(live.outgoing.nbytes for live in self))
        memory.give_back(self._give_encoders_back)
        memory.count("edits", lambda: sum(live.session.edits.nbytes for live in self))

    def _give_encoders_back(self, size: int) -> None:
        """Of sessions at rest, until so many bytes are free."""
        until = time.monotonic() - AT_REST_SECONDS
        for live in self:
            if size > 0 and live.outgoing.encoded_at < until:
                size -= live.outgoing.give_back()

    def __len__(self) -> int:
        return len(self._painter.pictures)

    def __iter__(self) -> Iterator[LivePicture]:
        return iter(self._painter.pictures.values())

    def __contains__(self, session: str) -> bool:
        return session in self._painter.pictures

    def get(self, session: str) -> LivePicture:
        """The session of that name, which thereby counts as used; NotFoundError, which does not say the name: whoever
        only watches must not learn it."""
        try:
            live = self._painter.pictures[session]
        except KeyError:
            raise NotFoundError(GONE) from None
        self._touched[session] = time.monotonic()
        return live

    def check(self, live: LivePicture) -> None:
        """NotFoundError if the session has been closed; it does not count as used. From any thread."""
        if self._painter.pictures.get(live.session.name) is not live:
            raise NotFoundError(GONE)

    def client(self, live: LivePicture) -> str | None:
        """Who opened the session, as its gateway called that client."""
        return self._clients.get(live.session.name)

    async def open(self, request: OpenSession) -> LivePicture:
        """A new session, or one that an engine before had; BusyError if there is no room."""
        if request.session in self:  # asked again by a gateway that heard nothing for a while
            return self.get(request.session)
        scene = Scene.read(request.scene)
        snapshot = None if request.snapshot is None else SessionSnapshot.read(request.snapshot)
        self._make_room()
        own = scene.environment if snapshot is None else snapshot.environment or scene.environment
        most = CHANGE_SECONDS if snapshot is None else math.inf  # what was there before comes again, whatever it takes
        patience = Patience(None if snapshot is None else math.inf)
        with self._wanted(request.session) as wanted:

            def check() -> None:
                wanted()
                patience.check()

            async with patience.enter(self._staging.turn(request.client)) as turn:
                work = partial(self._made, request.session, scene, own, snapshot)
                session = await turn.make(work, most_seconds=most, check=check)
            wanted()
        if request.session in self:  # opened twice at once
            return self.get(request.session)
        self._make_room()
        if request.client is not None:
            self._clients[request.session] = request.client
        live = self._painter.pictures[request.session] = LivePicture(session)
        live.outgoing.codecs = frozenset()
        for codec in STREAMS:
            if topic_of(live.session.key, codec) in self._subscriptions:
                live.outgoing.watch(codec, subscribed=True)
        live.watched = bool(live.outgoing.codecs)
        self._painter.wake()
        return self.get(request.session)

    @contextmanager
    def _wanted(self, session: str) -> Iterator[Callable[[], None]]:
        """While a session is being opened: raises NotFoundError once it was closed. From any thread."""
        closed = threading.Event()

        def check() -> None:
            if closed.is_set():
                raise NotFoundError(GONE)

        opening = self._opening.setdefault(session, set())
        opening.add(closed)
        try:
            yield check
        finally:
            opening.discard(closed)
            if not opening and self._opening.get(session) is opening:
                del self._opening[session]

    def close(self, session: str) -> None:
        """Forget the session, also while it is being opened; NotFoundError."""
        opening = self._opening.pop(session, ())
        for closed in opening:
            closed.set()
        if opening and session not in self:
            return
        pace = self.get(session).session.motion.pace
        self.simulated_seconds += pace.seconds
        self.dropped_seconds += pace.dropped
        self._painter.forget(session)
        del self._touched[session]
        self._clients.pop(session, None)

    def close_unwatched(self) -> None:
        """Forget the sessions that nobody watches."""
        for name in [live.session.name for live in self if not live.watched]:
            self.close(name)

    def watch(self, key: bytes, subscribed: bool) -> None:
        """Somebody began or ceased to receive the frames of the session with this watch id."""
        if subscribed and len(self._subscriptions) < SUBSCRIPTIONS:  # maybe before the session is opened
            self._subscriptions.add(key)
        elif not subscribed:
            self._subscriptions.discard(key)
        found = next(
            ((live, codec) for live in self for codec in STREAMS if topic_of(live.session.key, codec) == key), None
        )
        if found is None:
            return
        live, codec = found
        live.outgoing.watch(codec, subscribed=subscribed)
        live.watched = bool(live.outgoing.codecs)
        self._touched[live.session.name] = time.monotonic()
        if subscribed:
            self._painter.show_again(live, codec)

    def pace(self) -> dict[str, Any]:
        """How far the simulations are behind real time, for the status."""
        paces = [live.session.motion.pace for live in self]
        moving = [live.session.motion.pace for live in self if live.watched and live.session.motion.moving]
        return {
            "simulated_seconds": self.simulated_seconds + sum(pace.seconds for pace in paces),
            "simulated_seconds_dropped": self.dropped_seconds + sum(pace.dropped for pace in paces),
            "sessions_slow": sum(pace.slow for pace in moving),
            "slowest_pace": min((pace.lately for pace in moving), default=1.0),
        }

    def _make_room(self) -> None:
        """For one more session; BusyError."""
        with self._memory.reserved("sessions", SESSION_BYTES, "a session"):
            pass
        if len(self) < self._limits.max_sessions:
            return
        idle = [live.session.name for live in self if not live.watched]
        oldest = min(idle, key=lambda name: self._touched[name], default=None)
        if oldest is None or time.monotonic() - self._touched[oldest] < self._limits.engine_idle_seconds:
            raise BusyError(f"there are {self._limits.max_sessions} sessions already; close one, or try again later")
        self.close(oldest)

    def _made(
        self, name: str, scene: Scene, own: Environment, snapshot: SessionSnapshot | None, library: Library
    ) -> Session:
        """A session whose own sky is of that environment. Takes a while, as shapes and their hulls are made."""
        stage, sky = Stage.of(scene, library), events.own_sky(library.sky(own))
        if snapshot is None:
            return Session(name, stage, sky=sky, history=self._history())
        return Session.restored(name, stage, snapshot, sky=sky, history=self._history())


async def described(live: LivePicture) -> dict[str, Any]:
    """A session as the gateway is told of it."""
    session = live.session
    async with session.motion.still():
        state, found = session.described(), await asyncio.to_thread(overlaps, session.motion.world)
    return state | {
        "watched": live.watched,
        "step": session.shown.step,
        "simulation_time": session.shown.simulation_time,
        "pose": session.pose(),
        "width": live.size[0],
        "height": live.size[1],
        "findings": [*(finding for shape in session.stage.shapes for finding in shape.findings), *found],
    }
