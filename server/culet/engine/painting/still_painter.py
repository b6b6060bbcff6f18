"""Stills, a piece at a time: rendered on the render thread, encoded on one of their own."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from culet.engine.painting.counters import SharedCounters
from culet.engine.painting.failure import as_culet_error
from culet.engine.painting.frame_work import proceed
from culet.engine.painting.render_thread import RenderThread
from culet.engine.painting.renderer import AnyRenderer
from culet.engine.painting.still import EncodeStill, Still, StillQueue
from culet.errors import TooLargeError
from culet.rendering.chains import band_count


class StillPainter:
    """Works on the stills of a queue."""

    def __init__(
        self,
        queue: StillQueue,
        renderer: AnyRenderer,
        thread: RenderThread,
        encode: EncodeStill,
        most_seconds: float,
        tally: SharedCounters,
        clock: Callable[[], float],
    ) -> None:
        """A still may take `most_seconds` of the render thread."""
        self._queue = queue
        self._renderer = renderer
        self._thread = thread
        self._encode = encode
        self._most_seconds = most_seconds
        self._tally = tally
        self._now = clock
        self._encode_thread = ThreadPoolExecutor(1, "encode-still")
        self._encoding: set[asyncio.Task[None]] = set()

    async def advance(self, still: Still) -> None:
        """One piece of a still, or its end."""
        started = self._now()
        try:
            if still.pieces is None:
                self._tally.durations.still_wait.add(max(0.0, started - still.asked_at))
                still.pieces = still.paint(self._renderer)
            more = await self._thread.run(self._queue.account, proceed, still.pieces, self._now)
            self._queue.charge(still, self._now() - started, self._now())
            if more:
                self._check_time(still)
        except Exception as error:  # the one who asked is told
            self._fail(still, error)
            return
        if not more:
            still.rendered = True
            task = asyncio.create_task(self._encode_and_answer(still))
            self._encoding.add(task)
            task.add_done_callback(self._encoding.discard)

    def stop(self) -> None:
        """Encode nothing more."""
        self._encode_thread.shutdown(wait=False, cancel_futures=True)

    def _check_time(self, still: Still) -> None:
        most_seconds = self._most_seconds * still.part
        if still.spent <= most_seconds:
            return
        if still.target.error is not None and still.picture is not None and still.picture.samples > 0:
            still.out_of_time = True  # what was asked for is an error as far as that can be had
        else:
            raise TooLargeError(
                f"expected a picture that takes at most {most_seconds:g} s to render, got one of "
                f"{still.width} x {still.height} pixels, {still.target.samples} samples and "
                f"{band_count(still.stage.scene)} bands that is not done after them; ask for less of each",
                "samples",
            )

    async def _encode_and_answer(self, still: Still) -> None:
        assert still.picture is not None  # noqa: S101 - it is rendered
        try:
            data = await asyncio.get_running_loop().run_in_executor(
                self._encode_thread, self._encode, still.picture, still.format, still.legend
            )
        except Exception as error:  # as above
            self._fail(still, error)
            return
        self._queue.remove(still)
        self._tally.counters.stills_rendered += 1
        if not still.done.done():
            still.done.set_result(data)

    def _fail(self, still: Still, error: Exception) -> None:
        self._tally.counters.problems += 1
        self._queue.remove(still)
        if not still.done.done():
            still.done.set_exception(as_culet_error(error))
