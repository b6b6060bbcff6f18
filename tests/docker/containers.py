"""The containers of one Compose project, and what can happen to a process within."""

from __future__ import annotations

import asyncio
import contextlib
import datetime as dt
import json
import time
from collections.abc import AsyncIterator, Sequence
from pathlib import Path
from typing import Any

HOLD_THREADS = Path(__file__).with_name("hold_threads.py")
KILL = """
import os, pathlib, signal, sys
for folder in pathlib.Path("/proc").glob("[0-9]*"):
    words = (folder / "cmdline").read_bytes().split(b"\\0")
    if int(folder.name) not in (1, os.getpid()) and sys.argv[1].encode() in words:
        os.kill(int(folder.name), signal.SIGKILL)
"""
QUIET_SECONDS = 11.0
"""Docker waits longer before each restart of a container that ran for less than 10 s."""
HANG_SECONDS = 240.0
"""An engine that hangs ends itself after 20 s, or 150 s if a compiler was at work."""


class CommandError(SystemExit):
    """A command of Docker's failed; it has said why."""


class Containers:
    """What `docker compose` and its options stand for."""

    def __init__(self, compose: Sequence[str]) -> None:
        self._compose = compose
        self.fault_at = 0.0
        """When something was last done to a process, `time.monotonic`."""

    async def python(self, service: str, code: str, *words: str) -> str:
        """What a piece of Python prints in a service's container."""
        return await _said(*self._compose, "exec", "--no-TTY", service, "python3", "-c", code, *words)

    async def inspect(self, service: str) -> dict[str, Any]:
        """What Docker knows of a service's container."""
        described: list[dict[str, Any]] = json.loads(await _said("docker", "inspect", await self._container(service)))
        return described[0]

    async def restarts(self, service: str) -> int:
        """How often the restart policy brought the service back."""
        return int((await self.inspect(service))["RestartCount"])

    async def log(self, service: str) -> str:
        """All that it has said."""
        return await _said(*self._compose, "logs", "--no-log-prefix", service)

    async def quiet(self, service: str) -> None:
        """Wait until its container has run long enough for the next restart to be the first in a row."""
        while True:
            started = str((await self.inspect(service))["State"]["StartedAt"])[:19]  # to the second, UTC
            since = dt.datetime.now(dt.UTC) - dt.datetime.fromisoformat(f"{started}+00:00")
            if since.total_seconds() > QUIET_SECONDS:
                return
            await asyncio.sleep(0.5)

    async def kill(self, service: str) -> None:
        """SIGKILL to what a service's container is for, by its own user: nothing there may do more."""
        self.fault_at = time.monotonic()
        with contextlib.suppress(CommandError):  # which may be killed with the container
            await self.python(service, KILL, service)

    @contextlib.asynccontextmanager
    async def held(self, which: str) -> AsyncIterator[None]:
        """Hold threads of the engine from beside its container, which stays as confined as it is."""
        described = await self.inspect("engine")
        process = await asyncio.create_subprocess_exec(
            "docker", "run", "--rm", "--interactive", "--pid", f"container:{described['Id']}", "--network", "none",
            "--user", "root", "--cap-drop", "ALL", "--cap-add", "SYS_PTRACE", "--no-healthcheck",
            described["Config"]["Image"], "python3", "-", which,
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
        )  # fmt: skip
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(HOLD_THREADS.read_bytes())
        process.stdin.close()
        told = (await process.stdout.readline()).decode().strip()
        if not told.startswith("holding"):
            raise SystemExit(f"no thread of the engine could be held: {told or await process.wait()}")
        self.fault_at = time.monotonic()
        try:
            yield
        finally:
            try:
                async with asyncio.timeout(HANG_SECONDS):  # it ends with the engine
                    await process.wait()
            except TimeoutError:
                raise SystemExit(f"not true: an engine that hangs ends itself within {HANG_SECONDS:g} s") from None

    async def _container(self, service: str) -> str:
        return (await _said(*self._compose, "ps", "--all", "--quiet", service)).strip()


async def _said(*command: str) -> str:
    process = await asyncio.create_subprocess_exec(*command, stdout=asyncio.subprocess.PIPE)
    said, _ = await process.communicate()
    if process.returncode != 0:
        raise CommandError(f"{' '.join(command)} ended with code {process.returncode}")
    return said.decode()
