"""Ends an engine whose event loop or render thread stands still, so that whoever started it starts another.

Python's faulthandler does the watching, by a thread that needs no interpreter lock: it also ends a process that hangs
in a driver which holds that lock, and first writes where every thread stands.
"""

from __future__ import annotations

import asyncio
import faulthandler
import threading
from concurrent.futures import Executor

from culet.notify import ServiceNotice, notify, notify_patience
from culet.rendering.opencl import compiling

HANG_SECONDS = 20.0
"""Of standing still. Pieces of rendering take 0.1 s, on a loaded machine some more; shorter, and a machine that is busy
with something else for a while would lose its engine, longer, and viewers wait."""
COMPILER_SECONDS = 150.0
"""Of standing still while a compiler is at work: a program takes 3 s of a core, and more where many share it."""
BEAT_SECONDS = 0.5


class Watchdog:
    """From `run`'s start to its end."""

    def __init__(self, render_thread: Executor) -> None:
        self._render_thread = render_thread
        self._running = False
        self._compiling = False
        self._lock = threading.Lock()

    async def run(self) -> None:
        """See that the render thread answers, for ever; this task shows that the loop does."""
        loop = asyncio.get_running_loop()
        self._running = True
        compiling.listen(self._have_patience)
        self._arm()
        notify(ServiceNotice.READY)
        try:
            while True:
                await loop.run_in_executor(self._render_thread, _nothing)
                self._arm()
                notify(ServiceNotice.ALIVE)
                await asyncio.sleep(BEAT_SECONDS)
        finally:
            self._running = False
            faulthandler.cancel_dump_traceback_later()

    def _have_patience(self, compiler_at_work: bool) -> None:
        if self._running:
            notify_patience(self._arm(compiler_at_work))

    def _arm(self, compiling: bool | None = None) -> float:
        """From now on; s until it ends the process. A compiler may begin, in the render thread, just as the
        loop sees that this thread answered: what is known of compilers stays until they tell."""
        with self._lock:
            if compiling is not None:
                self._compiling = compiling
            seconds = COMPILER_SECONDS if self._compiling else HANG_SECONDS
            faulthandler.dump_traceback_later(seconds, exit=True)
        return seconds


def _nothing() -> None:
    pass
