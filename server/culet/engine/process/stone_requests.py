"""What is asked about one stone: its grades, its cutting diagram."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from typing import Any

from culet.engine.process.open_sessions import OpenSessions
from culet.engine.session import events
from culet.errors import InputError
from culet.geometry.cuts.wording import headings_of
from culet.geometry.designs.diagram import diagram_of
from culet.geometry.designs.of_shape import design_of
from culet.geometry.designs.solid import Solid
from culet.grading.answer import Report
from culet.grading.report import place_of, reports_of
from culet.grading.rules import rules_of
from culet.grading.size import size_of
from culet.grading.sums import LightSums
from culet.rendering.device import open_device
from culet.scene import Scene
from culet.stage import Library, Stage
from culet_protocol.engine import DrawDiagram, Grade


class StoneRequests:
    """One at a time, in a thread of their own, piece by piece: a request that is given up ends with its piece."""

    def __init__(self, sessions: OpenSessions, library: Library) -> None:
        """Sessions and uploads that requests name."""
        self._sessions = sessions
        self._library = library
        self._thread = ThreadPoolExecutor(1, "grades")
        self._turn = asyncio.Lock()
        self._sums: LightSums | None = None

    async def grade(self, request: Grade) -> dict[str, Any]:
        """A report; InputError, NotFoundError."""
        stage = await self._staged(request)
        rules = rules_of(request.convention, request.head_degrees)
        async with self._turn:
            sums = await self._in_thread(self._light_sums)
            reports = reports_of(
                sums, stage, rules, stone=request.stone, target=request.error, tilt=request.tilt,
                coloured=request.coloured,
            )  # fmt: skip
            report = None
            while (further := await self._in_thread(_next, reports)) is not None:
                report = further
        assert report is not None  # noqa: S101 - there is a first one, or an error
        return asdict(report)

    async def diagram(self, request: DrawDiagram) -> bytes:
        """An SVG file; InputError, NotFoundError."""
        stage = await self._staged(request)
        return await asyncio.to_thread(_diagram, stage, request.stone)

    async def _in_thread(self, work: Any, *given: Any) -> Any:  # noqa: ANN401 - as run_in_executor
        return await asyncio.get_running_loop().run_in_executor(self._thread, work, *given)

    def _light_sums(self) -> LightSums:
        if self._sums is None:
            self._sums = LightSums(open_device())
        return self._sums

    async def _staged(self, request: Grade | DrawDiagram) -> Stage:
        if (request.scene is None) == (request.session is None):
            raise InputError("expected either a scene or a session, got both or neither", "scene")
        if request.session is None:
            return await asyncio.to_thread(Stage.of, Scene.read(request.scene), self._library)
        live = self._sessions.get(request.session)
        async with live.session.lock:
            past, before = live.session.recall(None), events.known_to(live.session)
        return await asyncio.to_thread(events.past_stage, past, before, self._library)


def _next(reports: Iterator[Report]) -> Report | None:
    return next(reports, None)


def _diagram(stage: Stage, stone: str | None) -> bytes:
    place = place_of(stage, stone)
    settings, shape = stage.scene.stones[place], stage.shapes[place]
    size = size_of(shape, settings, stage.scene.millimetres)
    design = design_of(shape, [*headings_of(settings, shape), size.words()])
    return diagram_of(Solid(design)).encode("utf-8", "replace")
