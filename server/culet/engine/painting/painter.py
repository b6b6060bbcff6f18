"""The render loop: live frames, refinements and stills on one render thread, encoding on others.

Nobody watching, nothing rendered; at rest a picture is refined to REST_SAMPLES and then costs nothing but being sent
again once a second. The loop never waits for anything but one short piece of work of the render thread.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, TypeVar

from culet.engine.painting import jpeg, schedule
from culet.engine.painting.frame_work import FrameWork, Kind, Unprepared, proceed
from culet.engine.painting.histogram import Histogram
from culet.engine.painting.live_frame import LiveFrame
from culet.engine.painting.live_picture import NEVER, REST_SAMPLES, LivePicture
from culet.engine.painting.renderer import ALONE_SECONDS, Picture, Renderer
from culet.engine.painting.shares import Account, Shares, share
from culet.engine.painting.still import Still, StillQueue
from culet.engine.session.session import Shown
from culet.errors import CuletError, DeviceError, TooLargeError
from culet.stage import Stage

log = logging.getLogger(__name__)

SIMULATE_THREADS = 4
"""As many stones whose steps take long do not keep the others from moving."""
T = TypeVar("T")


@dataclass
class Counters:
    """Since the engine started."""

    frames_rendered: int = 0
    """Live pictures drawn."""
    frames_given_up: int = 0
    """For something newer, or because they took too long."""
    refinements: int = 0
    frames_sent: int = 0
    frames_repeated: int = 0
    stills_rendered: int = 0
    problems: int = 0
    """Pictures that could not be rendered, stones that could not be moved."""
    render_seconds: float = 0.0
    """Of the render thread."""


@dataclass
class Durations:
    """Since the engine started, s."""

    render_hold: Histogram = field(default_factory=Histogram)
    """That a piece of work held the render thread."""
    frame_wait: Histogram = field(default_factory=Histogram)
    """From when a frame was due until it was begun."""
    frame: Histogram = field(default_factory=Histogram)
    """From when a frame was begun until it was sent."""
    encode_wait: Histogram = field(default_factory=Histogram)
    """From when a frame was drawn until it was encoded."""
    still_wait: Histogram = field(default_factory=Histogram)
    """From when a still was asked for until it was begun."""

    def as_json(self) -> dict[str, Any]:
        """By name, of seconds."""
        return {f"{name}_seconds": histogram.as_json() for name, histogram in vars(self).items()}


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
        still_seconds: float = 3600.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`send` puts a frame on the wire, `report` tells of a session that could not go on; neither waits.

        A still may take `still_seconds` of the render thread. `clock` is a steady one, in seconds.
        """
        self.pictures: dict[str, LivePicture] = {}
        self.counters = Counters()
        self.durations = Durations()
        self._renderer = renderer
        self._render_thread = render_thread
        self._simulate_threads = ThreadPoolExecutor(SIMULATE_THREADS, "simulate")
        self._encode_thread = ThreadPoolExecutor(max(1, (os.cpu_count() or 1) // 2), "encode")
        self._still_thread = ThreadPoolExecutor(1, "encode-still")
        self._shares = Shares()
        self._stills = stills
        self._still_seconds = still_seconds
        self._send = send
        self._report = report
        self._encode_still = encode_still
        self._now = clock
        self._changed = asyncio.Event()
        self._encoding: set[asyncio.Task[None]] = set()

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
            self._simulate_threads.shutdown(wait=False, cancel_futures=True)
            self._encode_thread.shutdown(wait=False, cancel_futures=True)
            self._still_thread.shutdown(wait=False, cancel_futures=True)

    async def work(self) -> bool:
        """One piece of work, one repetition; whether there was anything."""
        pictures, now = list(self.pictures.values()), self._now()
        for live in pictures:
            if live.outdated(now):
                self.counters.frames_given_up += 1
                live.give_up(now)
            if not live.watched:
                live.abandon(now)
        chosen = schedule.next_work(pictures, self._stills, self._shares, now)
        if isinstance(chosen, LivePicture):
            await self._advance(chosen)
        elif chosen is not None and (still := chosen.next()) is not None:
            await self._advance_still(still)
        repeat = schedule.next_repeat(pictures, self._now())
        if repeat is not None and repeat.message is not None:
            self._send_again(repeat, repeat.message)
        return chosen is not None or repeat is not None

    async def make_ready(self, stage: Stage) -> None:
        """Have what a picture of the stage needs compiled, while others are drawn."""
        await in_daemon_thread(lambda: self._renderer.make_ready(stage))

    async def _rest(self) -> None:
        try:
            async with asyncio.timeout(schedule.idle_seconds(self.pictures.values(), self._now())):
                await self._changed.wait()
        except TimeoutError:
            pass

    async def _advance(self, live: LivePicture) -> None:
        """The next piece of a frame or of a refinement, begun if need be."""
        if live.work is None and live.wants_refinement():
            self._begin_refinement(live)
        if live.work is not None:
            await self._go_on(live, live.work)
        else:
            self._begin(live)

    def _begin(self, live: LivePicture) -> None:
        """Simulate up to now, while others are drawn: at the extremes a single step takes a second."""
        account, now, settled = live.next_account, self._now(), live.settled
        if live.begun_at > NEVER and (due_at := live.due_at()) is not None:
            self.durations.frame_wait.add(max(0.0, now - max(due_at, live.unwatched_at)))
        live.begin(now)
        live.beginning = asyncio.create_task(self._simulate(live, account, settled=settled))

    async def _simulate(self, live: LivePicture, account: Account, *, settled: bool) -> None:
        session = live.session
        try:
            async with session.lock:
                begun_at = self._now()  # waiting for the lock is no work that the next frame has to do again
                started = time.perf_counter()
                try:
                    await asyncio.get_running_loop().run_in_executor(
                        self._simulate_threads, session.advance, begun_at, self._share(live)
                    )
                except Exception as error:  # one session's failure must not end the others'; its stone has stopped
                    self._tell_problem(live, as_culet_error(error, CuletError, "simulating"))
                simulate_seconds = time.perf_counter() - started
                self._shares.charge(account, self._now() - begun_at, self._now())
                shown = session.shown
                session.remember(shown)
            if live.current and live.picture is not None and not settled:  # the simulation has not moved on
                return
            self._plan(live, shown, account, begun_at, simulate_seconds)
        except Exception as error:  # as above
            self._refuse(live, session.shown, error)
        finally:
            live.beginning = None
            self.wake()

    def _plan(self, live: LivePicture, shown: Shown, account: Account, begun_at: float, simulated: float) -> None:
        """Choose how to draw what is shown."""
        wanted = live.size  # as of now: it may change while the picture is rendered, which then is not current
        plan = live.governor.plan(shown.scene, wanted, live.balance) if live.governed else None
        kind = Kind.FULL if plan is None else Kind.PLANNED
        work = FrameWork(kind, shown, wanted, account, begun_at, plan, simulate_seconds=simulated)
        if self._share(live) >= 1:
            work.piece_seconds = ALONE_SECONDS
        work.slow = shown.moving and live.session.motion.pace.slow
        work.spent = self._now() - begun_at
        work.start(self._renderer)
        live.work = work

    def _begin_refinement(self, live: LivePicture) -> None:
        """As many samples more as the picture has."""
        picture, shown = live.picture, live.painted
        assert picture is not None  # noqa: S101 - of a picture that wants to be refined
        assert shown is not None  # noqa: S101 - likewise
        samples = min(picture.samples, REST_SAMPLES - picture.samples)
        live.work = FrameWork(
            Kind.REFINED, shown, live.painted_size, live.rest, self._now(), picture=picture, samples=samples,
            final=picture.samples + samples >= REST_SAMPLES, render_seconds=live.render_seconds,
        )  # fmt: skip
        live.work.start(self._renderer)

    async def _go_on(self, live: LivePicture, work: FrameWork) -> None:
        """The next piece; what is done is sent."""
        started = self._now()
        try:
            more = await self._in_render_thread(work.account, proceed, work.pieces, self._now)
        except Unprepared:
            live.work = None
            live.preparing = asyncio.create_task(self._prepare(live, work))
            return
        except Exception as error:  # as above
            self._refuse(live, work.shown, error)
            return
        work.spent += self._now() - started
        if more or work.frame is None or work.picture is None:
            return
        live.drew(work, self._now())
        if work.kind is Kind.REFINED:
            self.counters.refinements += 1
        else:
            self.counters.frames_rendered += 1
        if work.plan is not None:
            seconds = work.picture.seconds
            live.governor.rendered(
                work.plan, seconds, work.spent - seconds, live.frames_per_second, self._share(live)
            )  # fmt: skip
        self._publish(live, work.frame, work.begun_at)

    async def _prepare(self, live: LivePicture, work: FrameWork) -> None:
        try:
            await self.make_ready(work.stage)
        except Exception as error:  # as above
            self._refuse(live, work.shown, error)
        finally:
            live.preparing = None
            self.wake()

    def _share(self, live: LivePicture) -> float:
        """The part of the render thread's time that a session can have."""
        others = [account for other in self.pictures.values() for account in (other.frames, other.rest)]
        return share(live.frames, [*others, self._stills.account], self._now())

    async def _advance_still(self, still: Still) -> None:
        """One piece of a still, or its end."""
        started = self._now()
        try:
            if still.pieces is None:
                self.durations.still_wait.add(max(0.0, started - still.asked_at))
                still.pieces = still.paint(self._renderer)
            more = await self._in_render_thread(self._stills.account, proceed, still.pieces, self._now)
            self._stills.charge(still, self._now() - started, self._now())
            if more and still.spent > self._still_seconds:
                raise TooLargeError(
                    f"expected a picture that takes at most {self._still_seconds:g} s to render, got one of "
                    f"{still.width} x {still.height} pixels, {still.samples} samples and "
                    f"{still.stage.scene.optics.bands} bands that is not done after them; ask for less of each",
                    "samples",
                )
        except Exception as error:  # the one who asked is told
            self._fail_still(still, error)
            return
        if not more:
            still.rendered = True
            task = asyncio.create_task(self._encode_and_answer(still))
            self._encoding.add(task)
            task.add_done_callback(self._encoding.discard)

    async def _encode_and_answer(self, still: Still) -> None:
        assert still.picture is not None  # noqa: S101 - it is rendered
        try:
            data = await asyncio.get_running_loop().run_in_executor(
                self._still_thread, self._encode_still, still.picture, still.format
            )
        except Exception as error:  # as above
            self._fail_still(still, error)
            return
        self._stills.remove(still)
        self.counters.stills_rendered += 1
        if not still.done.done():
            still.done.set_result(data)

    def _fail_still(self, still: Still, error: Exception) -> None:
        self.counters.problems += 1
        self._stills.remove(still)
        if not still.done.done():
            still.done.set_exception(as_culet_error(error))

    def _publish(self, live: LivePicture, frame: LiveFrame, begun_at: float) -> None:
        """Encode and send while the next frame is rendered."""
        live.unsent += 1
        live.publishing = asyncio.create_task(self._encode_and_send(live, frame, begun_at, live.publishing))

    async def _encode_and_send(
        self, live: LivePicture, frame: LiveFrame, begun_at: float, before: asyncio.Task[None] | None
    ) -> None:
        drawn_at, started = self._now(), time.perf_counter()
        try:
            payload = await asyncio.get_running_loop().run_in_executor(
                self._encode_thread, lambda: jpeg.encode(frame.rgb, moving=frame.shown.moving)
            )
            encode_seconds = time.perf_counter() - started
            if before is not None:
                await asyncio.wait([before])  # so that frames leave in order
            live.session.sequence += 1
            message = frame.pack(live.session, payload, encode_seconds)
        except Exception as error:  # as above
            self._tell_problem(live, as_culet_error(error, what="encoding"))
            return
        finally:
            live.unsent -= 1
            self.wake()
        now = self._now()
        self.durations.encode_wait.add(max(0.0, now - drawn_at))
        self.durations.frame.add(max(0.0, now - begun_at))
        live.message = message
        live.sent_at = now
        self.counters.frames_sent += 1
        self._send(message)

    def _send_again(self, live: LivePicture, message: bytes) -> None:
        live.sent_at = self._now()
        self.counters.frames_repeated += 1
        self._send(message)

    def _refuse(self, live: LivePicture, shown: Shown, error: Exception) -> None:
        live.refuse(shown)
        self._tell_problem(live, as_culet_error(error))

    def _tell_problem(self, live: LivePicture, error: CuletError) -> None:
        self.counters.problems += 1
        self._report(live.session.name, error)

    async def _in_render_thread(self, account: Account, call: Callable[..., T], *arguments: object) -> T:
        """The account pays for the time that this holds the thread."""
        held = 0.0

        def timed() -> T:
            nonlocal held
            started = self._now()
            try:
                return call(*arguments)
            finally:
                held = self._now() - started

        try:
            return await asyncio.get_running_loop().run_in_executor(self._render_thread, timed)
        finally:
            self.counters.render_seconds += held
            self.durations.render_hold.add(held)
            self._shares.charge(account, held, self._now())


async def in_daemon_thread(call: Callable[[], None]) -> None:
    """As `asyncio.to_thread`, but a process that ends does not wait for it: a compiler may take long."""
    loop = asyncio.get_running_loop()
    done: asyncio.Future[None] = loop.create_future()

    def settle(error: Exception | None) -> None:
        if done.done():
            return
        if error is None:
            done.set_result(None)
        else:
            done.set_exception(error)

    def run() -> None:
        failure = None
        try:
            call()
        except Exception as error:
            failure = error
        with contextlib.suppress(RuntimeError):  # the loop is closed: nobody waits any more
            loop.call_soon_threadsafe(settle, failure)

    threading.Thread(target=run, name="make-ready", daemon=True).start()
    await done


def as_culet_error(error: Exception, kind: type[CuletError] = DeviceError, what: str = "rendering") -> CuletError:
    """The error itself, or one of that kind for one that nobody foresaw; the latter goes to the log too."""
    if isinstance(error, CuletError):
        return error
    log.error("%s failed", what, exc_info=error)
    return kind(f"{what} failed: {type(error).__name__}: {error}")
