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

import numpy as np
from numpy.typing import NDArray

from culet.engine import jpeg, schedule
from culet.engine.drawing import Picture, Renderer, band_rows
from culet.engine.live import REST_SAMPLES, SETTLE_SECONDS, LivePicture
from culet.engine.session import Shown
from culet.engine.still import Still, StillQueue
from culet.errors import CuletError, DeviceError
from culet.scene import Scene
from culet_protocol.frame import Codec, Flags, Frame

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
    """Pictures that could not be rendered."""
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
    ) -> None:
        """`send` puts a frame on the wire, `report` tells of a session that could not be rendered; neither waits."""
        self.pictures: dict[str, LivePicture] = {}
        self.counters = Counters()
        self._renderer = renderer
        self._render_thread = render_thread
        self._encode_thread = ThreadPoolExecutor(1, "encode")
        self._stills = stills
        self._send = send
        self._report = report
        self._encode_still = encode_still
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
                if not await self._work():
                    await self._rest()
        finally:
            self._encode_thread.shutdown(wait=False, cancel_futures=True)

    async def _work(self) -> bool:
        """One frame, one band, one repetition; whether there was anything."""
        pictures = list(self.pictures.values())
        for live in pictures:
            if not live.watched:
                live.abandon()
        frame = schedule.next_frame(pictures, time.monotonic())
        if frame is not None:
            await self._begin(frame)
        background = schedule.next_background(pictures, self._stills.first())
        if isinstance(background, Still):
            await self._advance_still(background)
        elif background is not None:
            await self._refine(background)
        repeat = schedule.next_repeat(pictures, time.monotonic())
        if repeat is not None and repeat.message is not None:
            self._send_again(repeat, repeat.message)
        return any(work is not None for work in (frame, background, repeat))

    async def _rest(self) -> None:
        try:
            async with asyncio.timeout(schedule.idle_seconds(self.pictures.values(), time.monotonic())):
                await self._changed.wait()
        except TimeoutError:
            pass

    async def _begin(self, live: LivePicture) -> None:
        """Simulate up to now and draw the first sample."""
        live.begun_at = time.monotonic()
        session = live.session
        live.refinement = None
        async with session.lock:
            started = time.perf_counter()
            await self._in_render_thread(session.advance, time.monotonic())
            live.simulate_seconds = time.perf_counter() - started
            shown = session.shown
            session.remember(shown)
        settled = live.reduced_until is not None and live.at_rest
        if live.current and live.picture is not None and not settled:  # the simulation has not moved on
            return
        changed = shown is not live.painted  # if not, only the size did
        governed = shown.moving or (changed and live.begun_at - live.changed_at < SETTLE_SECONDS)
        wanted = live.size  # as of now: it may change while the picture is rendered, which then is not current
        size = live.governor.size(*wanted) if governed else wanted
        scene = live.governor.simplified(shown.scene) if governed else shown.scene
        if changed:
            live.changed_at = live.begun_at
        try:
            picture = await self._in_render_thread(self._first_sample, scene, shown, size)
            if governed:
                live.governor.rendered(picture.seconds, size, wanted, live.frames_per_second)
            live.reduced_until = live.begun_at + SETTLE_SECONDS if governed else None
            live.picture, live.painted, live.painted_size, live.final = picture, shown, wanted, REST_SAMPLES <= 1
            self.counters.frames_rendered += 1
            await self._publish(live, picture, shown)
        except Exception as error:  # one session's failure must not end the others'
            self._refuse(live, shown, error)

    def _first_sample(self, scene: Scene, shown: Shown, size: tuple[int, int]) -> Picture:
        picture = self._renderer.picture(scene, shown.stone, *size, panorama=shown.panorama)
        picture.refine(1)
        return picture

    async def _refine(self, live: LivePicture) -> None:
        """One band of a refinement that doubles the samples."""
        picture, shown = live.picture, live.painted
        if picture is None or shown is None:
            return
        live.served_at = time.monotonic()
        if live.refinement is None:
            samples = min(picture.samples, REST_SAMPLES - picture.samples)
            live.refinement = picture.refine_in_bands(samples, band_rows(live.painted_size[0]))
        try:
            if await self._in_render_thread(_proceed, live.refinement):
                return
            live.refinement = None
            self.counters.refinements += 1
            live.final = picture.samples >= REST_SAMPLES
            await self._publish(live, picture, shown)
            if live.final:
                live.picture = None
        except Exception as error:  # as above
            self._refuse(live, shown, error)

    async def _advance_still(self, still: Still) -> None:
        """One band of a still, or its end."""
        still.served_at = time.monotonic()
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

    async def _publish(self, live: LivePicture, picture: Picture, shown: Shown) -> None:
        """Tone-map in the render thread, then encode and send while the next frame is rendered."""
        started = time.perf_counter()
        rgb, cut, error = await self._in_render_thread(_developed, picture)
        frame = _Unencoded(
            rgb, shown, picture.samples, picture.seconds, cut, error, live.final, time.perf_counter() - started
        )
        if live.publishing is not None:
            await live.publishing  # one frame at a time, so that they leave in order
        live.publishing = asyncio.create_task(self._encode_and_send(live, frame))

    async def _encode_and_send(self, live: LivePicture, frame: _Unencoded) -> None:
        started = time.perf_counter()
        payload = await asyncio.get_running_loop().run_in_executor(
            self._encode_thread, lambda: jpeg.encode(frame.rgb, moving=frame.shown.moving)
        )
        encode_seconds = frame.tone_map_seconds + time.perf_counter() - started
        live.session.sequence += 1
        message = frame.pack(live, payload, encode_seconds)
        live.message = message
        live.sent_at = time.monotonic()
        self.counters.frames_sent += 1
        self._send(message)

    def _send_again(self, live: LivePicture, message: bytes) -> None:
        live.sent_at = time.monotonic()
        self.counters.frames_repeated += 1
        self._send(message)

    def _refuse(self, live: LivePicture, shown: Shown, error: Exception) -> None:
        self.counters.problems += 1
        live.refused = shown
        live.abandon()
        self._report(live.session.name, as_culet_error(error))

    async def _in_render_thread(self, call: Callable[..., T], *arguments: object) -> T:
        started = time.perf_counter()
        try:
            return await asyncio.get_running_loop().run_in_executor(self._render_thread, call, *arguments)
        finally:
            self.counters.render_seconds += time.perf_counter() - started


@dataclass(frozen=True, eq=False)
class _Unencoded:
    """A frame before its payload is there."""

    rgb: NDArray[np.uint8]
    shown: Shown
    samples: int
    render_seconds: float
    cut: float
    error: float
    final: bool
    tone_map_seconds: float

    def pack(self, live: LivePicture, payload: bytes, encode_seconds: float) -> bytes:
        """The message to send."""
        flags = (Flags.MOVING if self.shown.moving else Flags.NONE) | (Flags.FINAL if self.final else Flags.NONE)
        height, width, _ = self.rgb.shape
        return Frame(
            session=live.session.key,
            codec=Codec.JPEG,
            flags=flags,
            sequence=live.session.sequence,
            width=width,
            height=height,
            samples=self.samples,
            step=self.shown.step,
            simulation_time=self.shown.simulation_time,
            timestamp=time.time(),
            simulate_ms=live.simulate_seconds * 1e3,
            render_ms=self.render_seconds * 1e3,
            encode_ms=encode_seconds * 1e3,
            cut=self.cut,
            error=self.error,
            payload=payload,
        ).pack()


def _developed(picture: Picture) -> tuple[NDArray[np.uint8], float, float]:
    """Pixels, cut weight and estimated error; the last costs nothing for the single sample of a moving picture."""
    return picture.rgb(), picture.cut(), picture.error_estimate()


def _proceed(bands: Iterator[object]) -> bool:
    """Render one band; whether there was one."""
    return next(bands, _DONE) is not _DONE


_DONE = object()


def as_culet_error(error: Exception) -> CuletError:
    """The error itself, or, of a kind that nobody foresaw, one that names it; that one goes to the log too."""
    if isinstance(error, CuletError):
        return error
    log.error("rendering failed", exc_info=error)
    return DeviceError(f"rendering failed: {type(error).__name__}: {error}")
