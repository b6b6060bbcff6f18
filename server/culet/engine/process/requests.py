"""What the engine answers to each request of the gateway."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, assert_never

from culet.engine.capacity.limits import Limits, live_size
from culet.engine.capacity.memory import Memory
from culet.engine.governing.thrift import ByteAllowance
from culet.engine.library.upload_process import Buffer
from culet.engine.library.upload_store import MESH, SKY, UploadStore
from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.painter import Painter
from culet.engine.painting.still import StillQueue
from culet.engine.process.in_use import sky_bytes, uploads_in_use
from culet.engine.process.open_sessions import SESSION_BYTES, OpenSessions, described
from culet.engine.process.picture_memory import size_within
from culet.engine.process.staging import (
    CHANGE_SECONDS,
    Patience,
    ShapesNeededError,
    Staging,
    to_its_end,
    without_shapes,
)
from culet.engine.process.still_requests import StillRequests
from culet.engine.process.stone_requests import StoneRequests
from culet.engine.session import events, questions
from culet.engine.session.session import Session
from culet.errors import InputError
from culet.optics.sky_files.picture import SkyPicture
from culet.stage import Library
from culet_protocol import engine as protocol
from culet_protocol.messages import SessionEvent
from culet_protocol.watch import LESSER_VIDEO, VIDEO_OF_NAME

SHAPING_EVENTS = frozenset({"patch_scene", "set_scene", "undo", "redo"})
"""They may make shapes, which takes their client's turn."""
LONG_EVENTS = SHAPING_EVENTS | frozenset(
    {
        "toggle_fall",
        "reset_stone",
        "toggle_walls",
        "push",
        "orbit",
        "translate",
        "dolly",
        "look_at_stone",
        "move_stone",
        "drag_stone",
        "turn_stone",
    }
)
"""They may make a stone or its hull, try whether a stone that sleeps would move, or look for a way among all triangles
of a mesh that the camera is near: other sessions go on meanwhile."""

ReplyParts = tuple[dict[str, Any], bytes | None]


class Requests:
    """The meaning of every request."""

    def __init__(
        self,
        painter: Painter,
        stills: StillQueue,
        limits: Limits,
        device: dict[str, Any],
        *,
        tell: Callable[[protocol.SessionChange], None],
        memory: Memory,
        forget_sky: Callable[[SkyPicture], object],
    ) -> None:
        """`tell` tells the gateway of an edit, `forget_sky` the renderer of a sky that no scene can name any more."""
        self.instance = os.urandom(8).hex()
        """Differs for every process."""
        self._painter = painter
        self._queue = stills
        self._limits = limits
        self._device = device
        self._tell = tell
        self._memory = memory
        self._meshes = UploadStore(MESH, limits, memory, in_use=self._uploads_in_use)
        self._skies = UploadStore(SKY, limits, memory, in_use=self._uploads_in_use, forgotten=forget_sky)
        self._library = Library(self._meshes, self._skies)
        self._changes = Staging(self._library)
        others = Staging(self._library)  # which may take as long as they need, and hold up no session meanwhile
        self.sessions = OpenSessions(painter, limits, memory, self._changes)
        self._stills = StillRequests(painter, stills, self.sessions, others, limits, memory)
        self._stones = StoneRequests(self.sessions, self._library, others, limits)
        self._question_thread = ThreadPoolExecutor(1, "questions")
        self._started = time.monotonic()
        memory.count("sessions", self._session_bytes)

    async def answer(self, request: protocol.Request, data: Buffer | None) -> ReplyParts:
        """Do what is asked; CuletError if it cannot be done."""
        match request:
            case protocol.OpenSession():
                return await described(await self.sessions.open(request)), None
            case protocol.CloseSession():
                self.sessions.close(request.session)
                return {}, None
            case protocol.GetSession():
                return await described(self.sessions.get(request.session)), None
            case protocol.GetScene():
                past = self.sessions.get(request.session).session.recall(request.step)
                return {"step": past.step, "scene": past.scene.model_dump(mode="json")}, None
            case protocol.ListSessions():
                clients = [
                    await described(live) | {"client": self.sessions.client(live)} for live in list(self.sessions)
                ]
                return {"sessions": clients}, None
            case protocol.Control():
                return await self._control(request), None
            case protocol.Ask():
                return await self._ask(request), None
            case protocol.Demand():
                return self._demand(request), None
            case protocol.HoldVideo():
                outgoing = self.sessions.get(request.session).outgoing
                codec, lesser = VIDEO_OF_NAME[request.codec], request.lesser
                outgoing.hold(LESSER_VIDEO[codec] if lesser else codec, time.monotonic(), held=request.held)
                return {}, None
            case protocol.Render():
                return await self._stills.render(request)
            case protocol.Grade():
                return await self._stones.grade(request), None
            case protocol.DrawDiagram():
                return {}, await self._stones.diagram(request)
            case protocol.Measure():
                return await self._stones.measure(request), None
            case protocol.ListTiers():
                return await self._stones.tiers(request), None
            case protocol.TracePath():
                return {}, await self._stones.path(request)
            case protocol.PutMesh():
                return await self._meshes.put(request.mesh, request.file_type, _file(data)), None
            case protocol.PutSky():
                return await self._skies.put(request.sky, request.file_type, _file(data)), None
            case protocol.Cancel():
                return {}, None
            case protocol.Status():
                return self.status(), None
            case _:
                assert_never(request)

    def status(self) -> dict[str, Any]:
        """Counters and device."""
        return {
            "instance": self.instance,
            "uptime_seconds": time.monotonic() - self._started,
            "sessions": len(self.sessions),
            "sessions_watched": sum(live.watched for live in self.sessions),
            "sessions_moving": sum(live.watched and live.session.motion.moving for live in self.sessions),
            "stills_waiting": len(self._queue),
            "meshes": len(self._meshes),
            "skies": len(self._skies),
            **vars(self._painter.counters),
            "memory_budget_bytes": self._memory.budget,
            **{f"memory_{kind}_bytes": size for kind, size in self._memory.held().items()},
            **self.sessions.pace(),
            **self._painter.durations.as_json(),
            "device": self._device,
        }

    async def _control(self, request: protocol.Control) -> dict[str, Any]:
        live = self.sessions.get(request.session)
        session, patience = live.session, Patience()
        try:
            async with patience.enter(session.lock):
                if request.event.type in SHAPING_EVENTS:
                    await self._reshape(live, request.event, patience)
                else:
                    await self._change(session, request.event, self._library)
        finally:
            self._painter.wake()
        return {"step": session.shown.step, "falling": session.motion.falling}

    async def _reshape(self, live: LivePicture, event: SessionEvent, patience: Patience) -> None:
        """An event that may make shapes: at once if it makes none, or else in a turn of the client."""
        session = live.session
        with suppress(ShapesNeededError):
            await self._change(session, event, without_shapes(self._library))
            return

        def check() -> None:
            self.sessions.check(live)  # for who waits for one that is closed, nothing is made
            patience.check()

        turn_of = self._changes.turn(self.sessions.client(live))
        async with patience.enter(turn_of) as turn, session.motion.still():
            with self._told(session):
                await turn.make(partial(events.apply, session, event), most_seconds=CHANGE_SECONDS, check=check)

    async def _change(self, session: Session, event: SessionEvent, library: Library) -> None:
        apply = partial(events.apply, session, event, library)
        async with session.motion.still():
            with self._told(session):
                if event.type in LONG_EVENTS:
                    await to_its_end(asyncio.ensure_future(asyncio.to_thread(apply)))
                else:
                    apply()

    @contextmanager
    def _told(self, session: Session) -> Iterator[None]:
        """Tell the gateways what an event has changed; an event that raises an error has changed nothing."""
        try:
            yield
        except asyncio.CancelledError:  # it may have been done by then
            self._tell(session.change_told(edited=True))
            raise
        self._tell(session.change_told(edited=True))

    async def _ask(self, request: protocol.Ask) -> dict[str, Any]:
        session = self.sessions.get(request.session).session
        async with session.asked:
            async with session.lock:
                work = questions.answering(session, request.question)
            answer = await asyncio.get_running_loop().run_in_executor(self._question_thread, work)
        return answer.model_dump(mode="json")

    def _demand(self, request: protocol.Demand) -> dict[str, Any]:
        live = self.sessions.get(request.session)
        others = [other for other in self.sessions if other is not live]
        live.rate = request.frames_per_second
        live.outgoing.allowance = ByteAllowance(request.bytes_per_frame, request.bytes_at_rest)
        if (less := request.lesser) is not None:
            live.outgoing.lesser.allowance = ByteAllowance(less.bytes_per_frame, less.bytes_at_rest)
            live.resize_lesser((less.width, less.height))
        live.size = size_within(
            self._memory,
            live_size(request.width, request.height, self._limits),
            live.session.scene.film,
            others,
        )
        self._painter.improve(live)
        self._painter.wake()
        return {"width": live.size[0], "height": live.size[1]}

    def _uploads_in_use(self) -> set[str]:
        return uploads_in_use(self.sessions, self._stills)

    def _session_bytes(self) -> int:
        """Of open sessions, and of what only they and their stills hold of skies."""
        kept = [sky.pixels for sky in self._skies.contents()]
        own = sum(SESSION_BYTES + live.outgoing.kept_bytes for live in self.sessions)
        return own + sky_bytes(self.sessions, self._stills, kept)


def _file(data: Buffer | None) -> Buffer:
    if data is None:
        raise InputError("expected the file's bytes as the third part of the message, got none")
    return data
