"""The engine as a child process: started, restarted when it dies, ended with this process however that ends."""

from __future__ import annotations

import asyncio
import contextlib
import ctypes
import logging
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Sequence

from culet.errors import EngineUnavailableError

log = logging.getLogger(__name__)

FIRST_BACKOFF_SECONDS = 0.25
LONGEST_BACKOFF_SECONDS = 10.0
STEADY_SECONDS = 20.0
"""An engine that lived so long had a good start: the next restart is quick again."""
STARTS_BEFORE_GIVING_UP = 4
"""Deaths in a row, each before STEADY_SECONDS, of an engine that never lived longer: it will not start here at all."""
STOP_SECONDS = 5.0
"""Between SIGTERM and SIGKILL."""
PR_SET_PDEATHSIG = 1
"""linux/prctl.h: the signal a process gets when its parent dies."""


def engine_command(control: str, *frames: str, options: Iterable[str] = ()) -> list[str]:
    """The command line of an engine that binds these endpoints; `options` are further words of it."""
    published = [word for endpoint in frames for word in ("--frames", endpoint)]
    return [sys.executable, "-m", "culet", "engine", "--control", control, *published, *options]


class Supervisor:
    """Keeps one engine process running until told to stop."""

    def __init__(self, command: Sequence[str], on_death: Callable[[str], None] = lambda _reason: None) -> None:
        """`command` starts the engine; `on_death` is told why when the engine ended without being asked to."""
        self._on_death = on_death
        self.command = list(command)
        self.starts = 0
        self._process: asyncio.subprocess.Process | None = None
        self._stopping = False

    @property
    def pid(self) -> int | None:
        """Process id of the engine that runs now."""
        return self._process.pid if self._process and self._process.returncode is None else None

    async def run(self) -> None:
        """Start the engine, and again whenever it dies; raise EngineUnavailableError if it never gets going."""
        backoff, short_lives, was_steady = FIRST_BACKOFF_SECONDS, 0, False
        while True:
            began = time.monotonic()
            code = await self._live()
            if self._stopping:
                return
            self._on_death(f"the render process ended with code {code}")
            if time.monotonic() - began > STEADY_SECONDS:
                backoff, short_lives, was_steady = FIRST_BACKOFF_SECONDS, 0, True
            short_lives += 1
            if short_lives >= STARTS_BEFORE_GIVING_UP and not was_steady:
                raise EngineUnavailableError(
                    f"the engine ended {short_lives} times in a row, last with code {code}; its messages are above"
                )
            log.warning("the engine ended with code %s; starting it again in %.2g s", code, backoff)
            await asyncio.sleep(backoff)
            backoff = min(2 * backoff, LONGEST_BACKOFF_SECONDS)

    async def stop(self) -> None:
        """End the engine: SIGTERM, then SIGKILL if it does not listen."""
        self._stopping = True
        process = self._process
        if process is None or process.returncode is not None:
            return
        with contextlib.suppress(ProcessLookupError):
            process.terminate()
        try:
            async with asyncio.timeout(STOP_SECONDS):
                await process.wait()
        except TimeoutError:
            log.warning("the engine did not stop within %g s and was killed", STOP_SECONDS)
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            await process.wait()

    async def _live(self) -> int:
        self.starts += 1
        # A session of its own: Ctrl-C in the terminal reaches this process alone, which then stops the engine in order.
        self._process = await asyncio.create_subprocess_exec(
            *self.command, start_new_session=True, preexec_fn=_die_with_parent()
        )
        return await self._process.wait()


def _die_with_parent() -> Callable[[], None] | None:
    """What the child does between fork and exec so that no engine outlives a killed parent (Linux only).

    The library is loaded before the fork: after it, only this one call may be made safely.
    """
    if sys.platform != "linux":
        return None
    prctl, parent = ctypes.CDLL(None, use_errno=True).prctl, os.getpid()

    def ask_the_kernel() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:  # it died before the call: no signal would come
            os._exit(1)

    return ask_the_kernel
