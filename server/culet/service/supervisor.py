"""Processes that are started, watched, replaced when they die or hang, and ended with this one however that ends."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import logging
import os
import signal
import socket
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from culet.errors import EngineUnavailableError
from culet.notify import ADDRESS, PATIENCE, ServiceNotice
from culet.parent import ending_with

log = logging.getLogger(__name__)

FIRST_BACKOFF_SECONDS = 0.25
"""Before the second of several restarts in a row; the first comes at once."""
LONGEST_BACKOFF_SECONDS = 10.0
STEADY_SECONDS = 20.0
"""A process that was ready and lived so long had a good start: its death is the first in a row."""
STARTS_BEFORE_GIVING_UP = 4
"""Of a process that was never ready: it will not start here at all."""
START_SECONDS = 180.0
"""Until a process is ready. A server that is new to its processor first compiles kernels, which takes some 10 s of one
core, and more where many share it."""
STOP_SECONDS = 5.0
"""Between SIGTERM and SIGKILL."""
SPARE_PAUSE_SECONDS = 3.0
"""From when a process is ready to the start of its spare, so that its first work comes first."""


@dataclass(frozen=True)
class ServerPart:
    """A process that is to be there always. It begins its work with a line on its standard input."""

    name: str
    command: Sequence[str]
    silence_seconds: float
    """One that is ready and does not say for so long that it lives is replaced."""
    environment: Mapping[str, str] = field(default_factory=dict)
    """Variables that it is given besides this process's: a command line is no place for secrets."""
    inherited: tuple[int, ...] = ()
    """File descriptors that it is given, by the same numbers."""
    has_spare: bool = False
    """Another one waits for that line, ready to take over."""
    start_seconds: float = START_SECONDS
    """One that is not ready by then is replaced."""
    drain_seconds: float = 0.0
    """When told to end, it may take so long to let those go who use it, unless it is told again."""


class Supervisor:
    """Keeps one process of a part running until told to stop."""

    def __init__(self, part: ServerPart, folder: Path, on_ready: Callable[[], None] = lambda: None) -> None:
        """`folder` is for the sockets by which processes say that they live; `on_ready` is told whenever one is
        ready."""
        self.part = part
        self.starts = 0
        self._folder = folder
        self._on_ready = on_ready
        self._numbers = itertools.count(1)
        self._current: _Process | None = None
        self._spare: _Process | None = None
        self._making_spare: asyncio.Task[None] | None = None
        self._stopping = asyncio.Event()

    @property
    def pid(self) -> int | None:
        """Process id of the one that works now."""
        return self._current.pid if self._current and self._current.returncode is None else None

    async def run(self) -> None:
        """Start the process, and another one whenever it ends; raise EngineUnavailableError if it never gets ready."""
        deaths, ever_ready, name = 0, False, self.part.name
        while True:
            began = time.monotonic()
            process = self._current = await self._next()
            if self._stopping.is_set():  # it was told to stop before there was a process
                await process.stop(name)
                return
            why = await self._watch(process)
            ever_ready = ever_ready or process.ready.is_set()
            if self._stopping.is_set():
                return
            if process.leaving:
                log.info("the %s %s, as it was asked to", name, why)
                return
            deaths = 1 if process.ready.is_set() and time.monotonic() - began > STEADY_SECONDS else deaths + 1
            if deaths >= STARTS_BEFORE_GIVING_UP and not ever_ready:
                raise EngineUnavailableError(f"the {name} {why}, {deaths} times in a row; its messages are above")
            pause = 0.0 if deaths == 1 else min(FIRST_BACKOFF_SECONDS * 2 ** (deaths - 2), LONGEST_BACKOFF_SECONDS)
            log.warning("the %s %s; starting it again%s", name, why, f" in {pause:.2g} s" if pause else "")
            if await self._stopped_within(pause):
                return

    async def stop(self, at_once: asyncio.Event | None = None) -> None:
        """End the processes: SIGTERM, and SIGINT for one that may take its time once `at_once` is set; then SIGKILL for
        one that does not listen."""
        self._stopping.set()
        if self._making_spare:
            await self._making_spare
        if self._spare:
            self._spare.kill()
        if self._current:
            await self._current.stop(self.part.name, self.part.drain_seconds, at_once)
        if self._spare:
            await self._spare.wait()

    async def _stopped_within(self, seconds: float) -> bool:
        """Wait; whether it is to stop."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._stopping.wait()
        return self._stopping.is_set()

    async def _next(self) -> _Process:
        """The process that stands by, if one does, and works from now on; or a new one."""
        spare, self._spare = self._spare, None
        if spare is not None and spare.returncode is None:
            spare.let_go()
            return spare
        process = await self._start()
        process.let_go()
        return process

    async def _start(self) -> _Process:
        self.starts += 1
        process = _Process(self._folder / f"{self.part.name}-{next(self._numbers)}", self.part.silence_seconds)
        await process.start(self.part)
        return process

    async def _watch(self, process: _Process) -> str:
        """Until the process has ended, by itself or because it hung; why, in words that follow its name."""
        ending = asyncio.create_task(process.wait())
        try:
            began = time.monotonic()
            while not process.ready.is_set():
                await asyncio.wait({ending}, timeout=0.02 if process.heard_at else 0.1)
                if ending.done():
                    return f"ended with code {ending.result()}"
                if time.monotonic() - began > self.part.start_seconds:
                    return await self._replace(process, f"was not ready within {self.part.start_seconds:g} s")
            self._on_ready()
            if self.part.has_spare and (self._making_spare is None or self._making_spare.done()):
                self._making_spare = asyncio.create_task(self._make_spare())
            while True:
                left = process.heard_at + process.silence_seconds - time.monotonic()
                if left <= 0:
                    return await self._replace(process, f"did not say for {process.silence_seconds:g} s that it lives")
                await asyncio.wait({ending}, timeout=left)
                if ending.done():
                    return f"ended with code {ending.result()}"
        finally:
            ending.cancel()

    async def _replace(self, process: _Process, why: str) -> str:
        process.kill()
        await process.wait()
        return f"{why} and was killed"

    async def _make_spare(self) -> None:
        if self._spare is not None and self._spare.returncode is None:
            return
        if not await self._stopped_within(SPARE_PAUSE_SECONDS):
            self._spare = await self._start()


class _Process:
    """One process, and what it says of itself."""

    def __init__(self, address: Path, silence_seconds: float) -> None:
        self.ready = asyncio.Event()
        self.leaving = False
        """It said that it is about to end, as somebody asked it to."""
        self.heard_at = 0.0
        """s, steady clock: when it last said that it lives."""
        self.silence_seconds = self._least_silence = silence_seconds
        """After which it counts as hung; it may ask for more."""
        self._address = address
        self._process: asyncio.subprocess.Process
        self._notices: socket.socket

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def returncode(self) -> int | None:
        return self._process.returncode

    async def start(self, part: ServerPart) -> None:
        """Start it. The socket is made anew for each, so that none is taken for another."""
        self._notices = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._notices.setblocking(False)
        self._notices.bind(str(self._address))
        loop = asyncio.get_running_loop()
        loop.add_reader(self._notices, self._hear)
        # A session of its own: Ctrl-C in the terminal reaches this process alone, which stops the others in order.
        self._process = await asyncio.create_subprocess_exec(
            *part.command,
            stdin=asyncio.subprocess.PIPE,
            env=os.environ | dict(part.environment) | {ADDRESS: str(self._address)},
            pass_fds=part.inherited,
            start_new_session=True,
            preexec_fn=ending_with(os.getpid()),
        )

    def let_go(self) -> None:
        """Have it begin its work."""
        self.heard_at = 0.0
        if self._process.stdin:
            with contextlib.suppress(OSError):
                self._process.stdin.write(b"go\n")

    def kill(self) -> None:
        """At once."""
        with contextlib.suppress(ProcessLookupError):
            self._process.kill()

    async def wait(self) -> int:
        """Its exit code, once it has ended."""
        code = await self._process.wait()
        self._close()
        return code

    async def stop(self, name: str, drain_seconds: float = 0.0, at_once: asyncio.Event | None = None) -> None:
        """End it in order, or else at once: it may take `drain_seconds` unless `at_once` is set."""
        with contextlib.suppress(ProcessLookupError):
            self._process.terminate()
        if drain_seconds > 0 and at_once is not None:
            ending, hurry = asyncio.create_task(self.wait()), asyncio.create_task(at_once.wait())
            await asyncio.wait({ending, hurry}, timeout=drain_seconds, return_when=asyncio.FIRST_COMPLETED)
            for task in (ending, hurry):
                task.cancel()
            await asyncio.gather(ending, hurry, return_exceptions=True)
            if at_once.is_set():
                with contextlib.suppress(ProcessLookupError):
                    self._process.send_signal(signal.SIGINT)
        try:
            async with asyncio.timeout(STOP_SECONDS):
                await self.wait()
        except TimeoutError:
            log.warning("the %s did not stop within %g s and was killed", name, STOP_SECONDS)
            self.kill()
            await self.wait()

    def _hear(self) -> None:
        with contextlib.suppress(BlockingIOError):
            while True:
                said = self._notices.recv(256).decode(errors="replace").split("\n")
                self.heard_at = time.monotonic()
                if ServiceNotice.READY in said:
                    self.ready.set()
                self.leaving = self.leaving or ServiceNotice.STOPPING in said
                for text in said:
                    name, _, value = text.partition("=")
                    if name == PATIENCE and value.isdecimal():
                        self.silence_seconds = max(int(value) / 1e6, self._least_silence)

    def _close(self) -> None:
        if self._notices.fileno() >= 0:
            asyncio.get_running_loop().remove_reader(self._notices)
            self._notices.close()
            self._address.unlink(missing_ok=True)
