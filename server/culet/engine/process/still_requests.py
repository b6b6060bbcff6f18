"""Stills that somebody asks for: of a scene, or of what a session showed."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator
from typing import Any

from culet.engine.painting.painter import Painter
from culet.engine.painting.still import SESSION_STILL_SAMPLES, Still, StillQueue
from culet.engine.process.limits import Limits, check_still_size, check_still_work
from culet.engine.process.memory import Memory
from culet.engine.process.open_sessions import OpenSessions
from culet.engine.process.picture_memory import picture_bytes
from culet.engine.session import events
from culet.errors import InputError
from culet.scene import Scene
from culet.stage import Library, Stage
from culet_protocol.engine import Render
from culet_protocol.sizes import STILL_SIZE


class StillRequests:
    """Those that wait; iterate to see them."""

    def __init__(
        self,
        painter: Painter,
        queue: StillQueue,
        sessions: OpenSessions,
        library: Library,
        limits: Limits,
        memory: Memory,
    ) -> None:
        """The painter renders what the queue holds."""
        self._painter = painter
        self._queue = queue
        self._sessions = sessions
        self._library = library
        self._limits = limits
        self._memory = memory
        self._awaited: set[Still] = set()

    def __iter__(self) -> Iterator[Still]:
        return iter(self._awaited)

    async def render(self, request: Render) -> tuple[dict[str, Any], bytes]:
        """Wait for a still; what it is, and its file. InputError, TooLargeError, NotFoundError or BusyError."""
        if (request.scene is None) == (request.session is None):
            raise InputError("expected either a scene or a session to render, got both or neither", "scene")
        stage, default_size, step = await self._staged(request)
        scene = stage.scene
        width = default_size[0] if request.width is None else request.width
        height = default_size[1] if request.height is None else request.height
        check_still_size(width, height, self._limits)
        samples = scene.sampling.samples_per_pixel
        if request.session is not None:
            samples = max(samples, SESSION_STILL_SAMPLES)
        check_still_work(width, height, samples, scene.optics.bands, self._limits)
        still = Still(stage, width, height, samples, request.format, request.client, time.monotonic())
        await self._painter.make_ready(stage)
        self._make_room_for(still)
        data = await self._painted(still)
        return {"width": width, "height": height, "samples": samples, "step": step, "format": request.format}, data

    async def _painted(self, still: Still) -> bytes:
        self._queue.put(still)
        self._awaited.add(still)
        self._painter.wake()
        try:
            return await still.done
        finally:  # also where nobody waits for it any more
            self._awaited.discard(still)
            self._queue.remove(still)
            self._painter.wake()

    async def _staged(self, request: Render) -> tuple[Stage, tuple[int, int], int | None]:
        """What is to be rendered, the usual size of its picture, and the session's step that it is of."""
        if request.session is None:
            return await asyncio.to_thread(Stage.of, Scene.read(request.scene), self._library), STILL_SIZE, None
        live = self._sessions.get(request.session)
        async with live.session.lock:
            past, before = live.session.recall(request.step), events.known_to(live.session)
        stage = await asyncio.to_thread(events.past_stage, past, before, self._library)
        return stage, live.size, past.step

    def _make_room_for(self, still: Still) -> None:
        """BusyError if it does not fit besides what is held and what waits, of which no more pixels are begun at a time
        than a largest still has."""
        waiting = [other for other in self._awaited if other.picture is None]
        needed = sum(picture_bytes(other.width, other.height) for other in (*waiting, still))
        most = picture_bytes(self._limits.max_still_pixels, 1)
        needed = max(picture_bytes(still.width, still.height), min(needed, most))
        with self._memory.reserved("stills", needed, f"a still of {still.width} x {still.height}"):
            pass
