"""The render loop: live frames, refinements and stills on one render thread, encoding on another.

Nobody watching, nothing rendered; at rest a picture is refined to REST_SAMPLES and then costs nothing but being sent
again once a second.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

from culet.engine import jpeg, schedule
from culet.engine.drawing import Picture, Renderer, band_rows
from culet.engine.governor import Plan
from culet.engine.live import REST_SAMPLES, LivePicture
from culet.engine.live_frame import LiveFrame
from culet.engine.session import Shown
from culet.engine.still import Still, StillQueue
from culet.errors import CuletError, DeviceError
from culet.scene import Scene

log = logging.getLogger(__name__)
T = TypeVar("T")


@dataclass
class Counters:
    """Since the engine started."""

    frames_rendered: int = 0
    """Live pictures begun."""
    refinements: int = 0
    frames_sent: int = 0
    frames_repeated: int = 0
    stills_rendered: int = 0
    problems: int = 0
    """Pictures that could not be rendered, stones that could not be moved."""
    render_seconds: float = 0.0
    """Of the render thread."""


class Painter:
    """Renders what is due; `run` until cancelled."""

    def __init__(
        self,
        renderer: Renderer,
        render_thread: ThreadPoolExecutor,
        stills: StillQueue,
        *,
        send: Callable[[bytes], None],
        report: Callable[[str, CuletError], None],
        encode_still: Callable[[Picture, str], bytes],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`send` puts a frame on the wire, `report` tells of a session that could not go on; neither waits.

        `clock` is a steady one, in seconds.
        """
        self.pictures: dict[str, LivePicture] = {}
        self.counters = Counters()
        self._renderer = renderer
        self._render_thread = render_thread
        self._encode_thread = ThreadPoolExecutor(1, "encode")
        self._stills = stills
        self._send = send
        self._report = report
        self._encode_still = encode_still
        self._now = clock
        self._changed = asyncio.Event()

    def wake(self) -> None:
        """Something changed: look again for what is due."""
        self._changed.set()

    def show_again(self, live: LivePicture) -> None:
        """Send the latest frame at once, for a viewer who has just come."""
        if live.current and live.message is not None:
            self._send_again(live, live.message)
        self.wake()

    async def run(self) -> None:
        """Paint for ever."""
        try:
            while True:
                self._changed.clear()
                if not await self.work():
                    await self._rest()
        finally:
            self._encode_thread.shutdown(wait=False, cancel_futures=True)

    async def work(self) -> bool:
        """One frame, one band, one repetition; whether there was anything."""
        pictures = list(self.pictures.values())
        for live in pictures:
            if not live.watched:
                live.abandon()
        frame = schedule.next_frame(pictures, self._now())
        if frame is not None:
            await self._begin(frame)
        background = schedule.next_background(pictures, self._stills.first())
        if isinstance(background, Still):
            await self._advance_still(background)
        elif background is not None:
            await self._refine(background)
        repeat = schedule.next_repeat(pictures, self._now())
        if repeat is not None and repeat.message is not None:
            self._send_again(repeat, repeat.message)
        return any(work is not None for work in (frame, background, repeat))

    async def _rest(self) -> None:
        try:
            async with asyncio.timeout(schedule.idle_seconds(self.pictures.values(), self._now())):
                await self._changed.wait()
        except TimeoutError:
            pass

    async def _begin(self, live: LivePicture) -> None:
        """Simulate up to now and draw the first sample."""
        live.begin(self._now())
        session = live.session
        live.refinement = None
        async with session.lock:
            held_at = self._now()  # waiting for the lock is no work that the next frame has to do again
            started = time.perf_counter()
            try:
                await self._in_render_thread(session.advance, self._now())
            except Exception as error:  # one session's failure must not end the others'; its stone has stopped
                self._tell_problem(live, as_culet_error(error, CuletError, "simulating"))
            live.simulate_seconds = time.perf_counter() - started
            shown = session.shown
            session.remember(shown)
        settled = live.reduced_until is not None and live.at_rest
        if live.current and live.picture is not None and not settled:  # the simulation has not moved on
            return
        wanted = live.size  # as of now: it may change while the picture is rendered, which then is not current
        plan = live.governor.plan(shown.scene, wanted, session.balance) if live.governed else None
        try:
            picture = await self._first_sample(live, plan, shown, wanted)
            live.drew(picture, shown, wanted, self._now(), reduced=plan is not None)
            if picture is None:
                return
            self.counters.frames_rendered += 1
            frame = await self._develop(live, picture, shown, plan)
            if plan is not None:
                overhead = self._now() - held_at - picture.seconds
                live.governor.rendered(plan, picture.seconds, overhead, live.frames_per_second)
            await self._publish(live, frame)
        except Exception as error:  # as above
            self._refuse(live, shown, error)

    async def _first_sample(
        self, live: LivePicture, plan: Plan | None, shown: Shown, wanted: tuple[int, int]
    ) -> Picture | None:
        """None if the picture was to be in full and something newer is to be shown before it is done."""
        if plan is not None:
            return await self._in_render_thread(self._reduced, plan, shown)
        picture = await self._in_render_thread(self._empty, shown.scene, shown, wanted)
        bands = picture.refine_in_bands(1, band_rows(wanted[0]))
        while await self._in_render_thread(_proceed, bands):
            if live.session.shown is not shown:
                return None
        return picture

    def _reduced(self, plan: Plan, shown: Shown) -> Picture:
        picture = self._empty(plan.scene, shown, plan.size)
        picture.refine(1)
        return picture

    def _empty(self, scene: Scene, shown: Shown, size: tuple[int, int]) -> Picture:
        return self._renderer.picture(scene, shown.stone, *size, panorama=shown.panorama)

    async def _refine(self, live: LivePicture) -> None:
        """One band of a refinement that doubles the samples."""
        picture, shown = live.picture, live.painted
        if picture is None or shown is None:
            return
        live.served_at = self._now()
        if live.refinement is None:
            samples = min(picture.samples, REST_SAMPLES - picture.samples)
            live.refinement = picture.refine_in_bands(samples, band_rows(live.painted_size[0]))
        try:
            if await self._in_render_thread(_proceed, live.refinement):
                return
            live.refinement = None
            live.render_seconds += picture.seconds
            self.counters.refinements += 1
            live.final = picture.samples >= REST_SAMPLES
            await self._publish(live, await self._develop(live, picture, shown, None))
            if live.final:
                live.picture = None
        except Exception as error:  # as above
            self._refuse(live, shown, error)

    async def _advance_still(self, still: Still) -> None:
        """One band of a still, or its end."""
        still.served_at = self._now()
        try:
            if still.bands is None:
                still.bands = still.paint(self._renderer)
            if await self._in_render_thread(_proceed, still.bands):
                return
            assert still.picture is not None  # noqa: S101 - made before the first band
            data = await asyncio.get_running_loop().run_in_executor(
                self._encode_thread, self._encode_still, still.picture, still.format
            )
        except Exception as error:  # the one who asked is told
            self.counters.problems += 1
            self._stills.remove(still)
            if not still.done.done():
                still.done.set_exception(as_culet_error(error))
            return
        self._stills.remove(still)
        self.counters.stills_rendered += 1
        if not still.done.done():
            still.done.set_result(data)

    async def _develop(self, live: LivePicture, picture: Picture, shown: Shown, plan: Plan | None) -> LiveFrame:
        spent = live.simulate_seconds, live.render_seconds
        return await self._in_render_thread(LiveFrame.developed, picture, shown, plan, spent, live.final)

    async def _publish(self, live: LivePicture, frame: LiveFrame) -> None:
        """Encode and send while the next frame is rendered."""
        if live.publishing is not None:
            await live.publishing  # one frame at a time, so that they leave in order
        live.publishing = asyncio.create_task(self._encode_and_send(live, frame))

    async def _encode_and_send(self, live: LivePicture, frame: LiveFrame) -> None:
        started = time.perf_counter()
        payload = await asyncio.get_running_loop().run_in_executor(
            self._encode_thread, lambda: jpeg.encode(frame.rgb, moving=frame.shown.moving)
        )
        live.session.sequence += 1
        message = frame.pack(live.session, payload, time.perf_counter() - started)
        live.message = message
        live.sent_at = self._now()
        self.counters.frames_sent += 1
        self._send(message)

    def _send_again(self, live: LivePicture, message: bytes) -> None:
        live.sent_at = self._now()
        self.counters.frames_repeated += 1
        self._send(message)

    def _refuse(self, live: LivePicture, shown: Shown, error: Exception) -> None:
        live.refused = shown
        live.abandon()
        self._tell_problem(live, as_culet_error(error))

    def _tell_problem(self, live: LivePicture, error: CuletError) -> None:
        self.counters.problems += 1
        self._report(live.session.name, error)

    async def _in_render_thread(self, call: Callable[..., T], *arguments: object) -> T:
        started = time.perf_counter()
        try:
            return await asyncio.get_running_loop().run_in_executor(self._render_thread, call, *arguments)
        finally:
            self.counters.render_seconds += time.perf_counter() - started


def _proceed(bands: Iterator[object]) -> bool:
    """Render one band; whether there was one."""
    return next(bands, _DONE) is not _DONE


_DONE = object()


def as_culet_error(error: Exception, kind: type[CuletError] = DeviceError, what: str = "rendering") -> CuletError:
    """The error itself, or one of that kind for one that nobody foresaw; the latter goes to the log too."""
    if isinstance(error, CuletError):
        return error
    log.error("%s failed", what, exc_info=error)
    return kind(f"{what} failed: {type(error).__name__}: {error}")
