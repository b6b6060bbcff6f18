"""What is asked about one stone, or one ray: grades, proportions, tiers, a cutting diagram, the way of the light."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import asdict
from functools import partial
from typing import Any, TypeVar

from pydantic import TypeAdapter

from culet.engine.capacity.limits import Limits
from culet.engine.process.open_sessions import OpenSessions
from culet.engine.process.staging import Staging
from culet.engine.session import events
from culet.errors import InputError, MeshError
from culet.geometry.cuts.wording import headings_of
from culet.geometry.cutting.tier_angles import tiers_of
from culet.geometry.designs.diagram import diagram_of
from culet.geometry.designs.measures import proportions_of
from culet.geometry.designs.of_shape import design_of
from culet.geometry.designs.solid import Solid
from culet.geometry.shape import Shape
from culet.grading.answer import GradeReport
from culet.grading.report import place_of, reports_of
from culet.grading.rules import rules_of
from culet.grading.size import size_of
from culet.grading.sums import LightSums
from culet.paths.answer import Path
from culet.paths.asked import Pixel, Ray, answered
from culet.paths.recorder import PathRecorder
from culet.rendering.features import MOST_HALF_SPACES
from culet.rendering.light.effort import LightEffort
from culet.rendering.opencl.device import open_device
from culet.scene import Scene
from culet.stage import Library, Stage
from culet_protocol.engine import DrawDiagram, Grade, ListTiers, Measure, TracePath

T = TypeVar("T")

PATH: TypeAdapter[Path] = TypeAdapter(Path)
LIGHT_SECONDS = 20.0
"""Of a ray's light map, some hundred times what the default cut-off takes: others wait for the same thread."""


class StoneRequests:
    """Grades piece by piece in a thread of their own, those of several requests in turn: a request that is given up
    ends with its piece, and so does a ray's. Diagrams, proportions and tiers one at a time in another, rays in a
    third."""

    def __init__(self, sessions: OpenSessions, library: Library, staging: Staging, limits: Limits) -> None:
        """Sessions and uploads that requests name."""
        self._sessions = sessions
        self._library = library
        self._staging = staging
        self._seconds = limits.grade_seconds
        self._grading = ThreadPoolExecutor(1, "grades")
        self._cutting = ThreadPoolExecutor(1, "cutting")
        self._tracing = ThreadPoolExecutor(1, "paths")
        self._sums: LightSums | None = None
        self._recorder: PathRecorder | None = None

    async def grade(self, request: Grade) -> dict[str, Any]:
        """A report, of what was reached within the time of one; InputError, NotFoundError."""
        stage = await self._staged(request)
        rules = rules_of(request.convention, request.head_degrees)
        sums = await _in(self._grading, self._light_sums)
        reports = reports_of(
            sums, stage, rules, stone=request.stone, target=request.error, tilt=request.tilt, coloured=request.coloured
        )
        report, spent = None, 0.0
        while report is None or spent < self._seconds:
            further, seconds = await _in(self._grading, _next, reports)
            if further is None:
                break
            report, spent = further, spent + seconds
        assert report is not None  # noqa: S101 - there is a first one, or an error
        return asdict(report)

    async def diagram(self, request: DrawDiagram) -> bytes:
        """An SVG file; InputError, NotFoundError."""
        stage = await self._staged(request)
        return await _in(self._cutting, _diagram, stage, request.stone)

    async def measure(self, request: Measure) -> dict[str, Any]:
        """Proportions, in R; InputError, NotFoundError."""
        stage = await self._staged(request)
        return await _in(self._cutting, _measured, stage, request.stone)

    async def tiers(self, request: ListTiers) -> dict[str, Any]:
        """Tiers with their angles; InputError, NotFoundError."""
        stage = await self._staged(request)
        return await _in(self._cutting, _tiers, stage, self._library, request.stone, request.reach)

    async def path(self, request: TracePath) -> bytes:
        """JSON of all that becomes of a pixel's light, or a ray's; InputError, NotFoundError. What a session shows is
        soon another scene, so that its light map is made in one pass."""
        asked = _asked(request)
        stage = await self._staged(request)
        effort = LightEffort.PATIENT if request.session is None else LightEffort.RESTING
        given_up = threading.Event()
        try:
            return await _in(self._tracing, self._traced, stage, asked, request.wavelengths, effort, given_up)
        finally:
            given_up.set()

    def _traced(
        self,
        stage: Stage,
        asked: Pixel | Ray,
        wavelengths: Sequence[float],
        effort: LightEffort,
        given_up: threading.Event,
    ) -> bytes:
        if self._recorder is None:
            self._recorder = PathRecorder(open_device(), apart=True, light_seconds=LIGHT_SECONDS)
        path = answered(
            self._recorder, stage, asked, wavelengths=wavelengths, effort=effort,
            waited_for=lambda: not given_up.is_set(),
        )  # fmt: skip
        return PATH.dump_json(path)  # not on a loop: of thousands of steps that takes longer than a frame

    def _light_sums(self) -> LightSums:
        if self._sums is None:
            self._sums = LightSums(open_device())
        return self._sums

    async def _staged(self, request: Grade | DrawDiagram | Measure | ListTiers | TracePath) -> Stage:
        if (request.scene is None) == (request.session is None):
            raise InputError("expected either a scene or a session, got both or neither", "scene")
        if request.session is None:
            return await self._staging.make(request.client, partial(Stage.of, Scene.read(request.scene)))
        live = self._sessions.get(request.session)
        async with live.session.lock:
            past, before = live.session.recall(None), events.known_to(live.session)
        return await self._staging.make(request.client, partial(events.past_stage, past, before))


async def _in(thread: Executor, work: Callable[..., T], *given: Any) -> T:  # noqa: ANN401 - of any work
    return await asyncio.get_running_loop().run_in_executor(thread, work, *given)


def _asked(request: TracePath) -> Pixel | Ray:
    if request.pixel is not None and request.ray is None:
        return Pixel(*request.pixel)
    if request.ray is not None and request.pixel is None:
        return Ray(*request.ray)
    raise InputError("pixel: expected either a pixel or a ray, got both or neither", "pixel")


def _next(reports: Iterator[GradeReport]) -> tuple[GradeReport | None, float]:
    """The next one, if there is one, and the seconds that it took."""
    begun = time.monotonic()
    return next(reports, None), time.monotonic() - begun


def _measured(stage: Stage, stone: str | None) -> dict[str, Any]:
    place = place_of(stage, stone)
    shape = _of_few_facets(stage.shapes[place])
    return asdict(proportions_of(Solid(design_of(shape))))


def _tiers(stage: Stage, library: Library, stone: str | None, reach: int | None) -> dict[str, Any]:
    place = place_of(stage, stone)
    stones = list(stage.scene.stones)
    recut, stones[place] = stones[place].recut, stones[place].model_copy(update={"recut": None})
    uncut = Stage.of(stage.scene.model_copy(update={"stones": tuple(stones)}), library, before=stage)
    return asdict(tiers_of(stage.shapes[place], uncut.shapes[place], recut, reach))


def _of_few_facets(shape: Shape) -> Shape:
    """The shape; MeshError if it has more facets than anybody cuts."""
    if len(shape.planes) > MOST_HALF_SPACES:
        raise MeshError(
            f"{shape.name}: expected a stone of at most {MOST_HALF_SPACES} facets to draw; got {len(shape.planes)}"
        )
    return shape


def _diagram(stage: Stage, stone: str | None) -> bytes:
    place = place_of(stage, stone)
    settings, shape = stage.scene.stones[place], _of_few_facets(stage.shapes[place])
    size = size_of(shape, settings, stage.scene.millimetres)
    design = design_of(shape, [*headings_of(settings, shape), size.words()])
    return diagram_of(Solid(design)).encode("utf-8", "replace")
