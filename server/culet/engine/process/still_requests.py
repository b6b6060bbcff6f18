"""Stills that somebody asks for: of a scene, or of what a session showed."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from culet.engine.capacity.limits import Limits, check_still_size, check_still_work, most_samples
from culet.engine.capacity.memory import Memory
from culet.engine.painting.painter import Painter
from culet.engine.painting.still import LINEAR_FORMATS, Still, StillQueue, pictures_of
from culet.engine.process.open_sessions import OpenSessions
from culet.engine.process.picture_memory import picture_bytes
from culet.engine.process.staging import Staging, Work
from culet.engine.session import events
from culet.errors import InputError, SceneError
from culet.rendering.chains import band_count
from culet.rendering.film.target import Target
from culet.scene import Scene
from culet.scene.patch import read_patched
from culet.stage import Stage
from culet_protocol.engine import Render
from culet_protocol.sizes import STILL_SIZE

if TYPE_CHECKING:
    from culet.legend import Line


def quality(still: Still, *, promised: bool) -> dict[str, Any]:
    """What a still that is done has reached: samples, error if that is known, and whether an error promised is met."""
    picture, target = still.picture, still.target
    assert picture is not None  # noqa: S101 - it is done
    error = picture.shown_error()
    met = picture.meets(target) if promised and target.error is not None else None
    return {"samples": picture.samples, "error": None if math.isnan(error) else error, "met": met}


class StillRequests:
    """Those that wait; iterate to see them."""

    def __init__(
        self,
        painter: Painter,
        queue: StillQueue,
        sessions: OpenSessions,
        staging: Staging,
        limits: Limits,
        memory: Memory,
    ) -> None:
        """The painter renders what the queue holds."""
        self._painter = painter
        self._queue = queue
        self._sessions = sessions
        self._staging = staging
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
        check_still_size(width, height, self._limits, pictures=pictures_of(scene))
        target = self._target(request, scene, width, height)
        legend = self._legend(request, scene, width, height)
        still = Still(
            stage, width, height, target, request.format, request.client, request.part, legend, time.monotonic()
        )
        for samples in range(min(2, target.samples)):  # the second sample may need another program than the first
            await self._painter.make_ready(stage, samples)
        self._make_room_for(still)
        data = await self._painted(still)
        promised = request.session is not None or request.error is not None
        reached = quality(still, promised=promised)
        reached |= {"width": width, "height": height, "step": step, "format": request.format}
        return reached, data

    def _legend(self, request: Render, scene: Scene, width: int, height: int) -> Sequence[Line]:
        """What is drawn into the picture; InputError where none can be."""
        if not request.legend:
            return ()
        if request.format in LINEAR_FORMATS:
            raise InputError(f"legend: expected a format for screens, got {request.format} of radiance", "legend")
        from culet.legend import legend_for  # of the few that ask for it

        return legend_for(scene, width, height)

    def _target(self, request: Render, scene: Scene, width: int, height: int) -> Target:
        """What is asked for, of a session by default what it has at rest. InputError if it is too much work."""
        limits = self._limits.model_copy(update={"max_still_work": self._limits.max_still_work * request.part})
        bands, own = band_count(scene) * pictures_of(scene), scene.sampling.samples_per_pixel
        target = Target.of(request.samples, request.error, scene)
        if request.session is not None and request.samples is None and request.error is None:
            rest = self._limits.rest
            target = replace(rest, samples=max(rest.samples, own), least=max(rest.least, own))
        if target.error is None or request.samples is not None:
            check_still_work(width, height, target.samples, bands, limits)
            return target
        check_still_work(width, height, own if request.error is None else target.least, bands, limits)
        most = most_samples(width, height, bands, limits)
        return replace(target, samples=min(target.samples, most), least=min(target.least, most))

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
            scene = Scene.read(request.scene)
            return await self._staging.make(request.client, partial(Stage.of, scene)), STILL_SIZE, None
        live = self._sessions.get(request.session)
        async with live.session.lock:
            past, before = live.session.recall(request.step), events.known_to(live.session)
        if request.design is None:
            work: Work[Stage] = partial(events.past_stage, past, before)
        else:
            work = partial(Stage.of, _otherwise(past.scene, request.stone, request.design), before=before)
        stage = await self._staging.make(request.client, work)
        return stage, live.size, past.step

    def _make_room_for(self, still: Still) -> None:
        """BusyError if it does not fit besides what is held and what waits, of which no more pixels are begun at a time
        than a largest still has."""
        waiting = [other for other in self._awaited if other.picture is None]
        needed = sum(picture_bytes(other.pixels, 1, other.stage.scene.film) for other in (*waiting, still))
        most = picture_bytes(self._limits.max_still_pixels, 1, still.stage.scene.film)
        needed = max(picture_bytes(still.pixels, 1, still.stage.scene.film), min(needed, most))
        with self._memory.reserved("stills", needed, f"a still of {still.width} x {still.height}"):
            pass


def _otherwise(scene: Scene, stone: str | None, design: Mapping[str, Any]) -> Scene:
    """The scene with one stone of another design; SceneError where there is no such stone, or no such design."""
    there = [each.id for each in scene.stones]
    if stone not in there:
        raise SceneError(
            f"stone: expected the id of a stone ({', '.join(there) or 'none'}), got {stone!r:.60}", "stone"
        )
    before = scene.model_dump(mode="json")
    stones = [
        {name: value for name, value in each.items() if not (each["id"] == stone and name in design)}
        for each in before["stones"]
    ]  # or what is given would be merged into the stone's own, as angles of tiers
    return read_patched(before | {"stones": stones}, {"stones": {stone: design}})
