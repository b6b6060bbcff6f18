"""Ends an engine whose event loop or render thread stands still, so that whoever started it starts another.

Python's faulthandler does the watching, by a thread that needs no interpreter lock: it also ends a process that hangs
in a driver which holds that lock, and first writes where every thread stands.
"""

from __future__ import annotations

import asyncio
import faulthandler
from concurrent.futures import Executor

from culet.notify import Notice, notify, notify_patience
from culet.rendering import compiling

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

    async def run(self) -> None:
        """See that the render thread answers, for ever; this task shows that the loop does."""
        loop = asyncio.get_running_loop()
        self._running = True
        compiling.listen(self._have_patience)
        self._arm(HANG_SECONDS)
        notify(Notice.READY)
        try:
            while True:
                await loop.run_in_executor(self._render_thread, _nothing)
                self._arm(HANG_SECONDS)
                notify(Notice.ALIVE)
                await asyncio.sleep(BEAT_SECONDS)
        finally:
            self._running = False
            faulthandler.cancel_dump_traceback_later()

    def _have_patience(self, compiler_at_work: bool) -> None:
        if not self._running:
            return
        seconds = COMPILER_SECONDS if compiler_at_work else HANG_SECONDS
        self._arm(seconds)
        notify_patience(seconds)

    def _arm(self, seconds: float) -> None:
        faulthandler.dump_traceback_later(seconds, exit=True)


def _nothing() -> None:
    pass
