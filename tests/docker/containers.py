"""The containers of one Compose project, and what can happen to a process within."""

from __future__ import annotations

import asyncio
import contextlib
import datetime as dt
import json
import signal
import time
from collections.abc import AsyncIterator, Sequence
from pathlib import Path
from typing import Any

HOLD_THREADS = Path(__file__).with_name("hold_threads.py")
WORKERS = """
import json, pathlib
found = []
for folder in pathlib.Path("/proc").glob("[0-9]*"):
    words = (folder / "cmdline").read_bytes().split(b"\\0")
    if b"--stand-by" in words or b"culet.gateway.inherited" in words:
        found.append((int((folder / "stat").read_text().rpartition(") ")[2].split()[19]), int(folder.name)))
print(json.dumps(sorted(found)))
"""
"""Processes that do, or will do, what a container is for: when each was started (ticks; proc(5)), and its id."""
KILL = "import os, sys; os.kill(int(sys.argv[1]), int(sys.argv[2]))"
KILL_ALL = """
import os, pathlib, signal, sys
for folder in pathlib.Path("/proc").glob("[0-9]*"):
    words = (folder / "cmdline").read_bytes().split(b"\\0")
    if int(folder.name) not in (1, os.getpid()) and sys.argv[1].encode() in words:
        os.kill(int(folder.name), signal.SIGKILL)
"""
QUIET_SECONDS = 21.0
"""Of several deaths in a row, each within 20 s of the start before, the second and further ones wait for the next
process; so does Docker, within 10 s."""
HANG_SECONDS = 240.0
"""An engine that hangs ends itself after 20 s, or 150 s if a compiler was at work."""


class CommandError(SystemExit):
    """A command of Docker's failed; it has said why."""


class Container:
    """One of them."""

    def __init__(self, identity: str) -> None:
        self.identity = identity

    async def run(self, *command: str) -> str:
        """What a program prints there, run by the container's own user."""
        return await said("docker", "exec", self.identity, *command)

    async def python(self, code: str, *words: str) -> str:
        """What a piece of Python prints there."""
        return await self.run("python3", "-c", code, *words)

    async def inspect(self) -> dict[str, Any]:
        """What Docker knows of it."""
        described: list[dict[str, Any]] = json.loads(await said("docker", "inspect", self.identity))
        return described[0]

    async def kill(self) -> None:
        """As a power cut would: Docker does not start it again."""
        await said("docker", "kill", self.identity)

    async def start(self) -> None:
        """Again."""
        await said("docker", "start", self.identity)

    async def workers(self) -> list[tuple[int, int]]:
        """The processes that do what it is for, the ones that work first; others stand by."""
        try:
            found: list[list[int]] = json.loads(await self.python(WORKERS))
        except CommandError:  # it is being started again
            return []
        return [(since, process) for since, process in found]


class Containers:
    """What `docker compose` and its options stand for."""

    def __init__(self, compose: Sequence[str]) -> None:
        self._compose = compose
        self.fault_at = 0.0
        """When something was last done to a process, `time.monotonic`."""

    async def all(self, service: str) -> list[Container]:
        """A service's containers, the eldest first."""
        identities = (await said(*self._compose, "ps", "--all", "--quiet", service)).split()
        found = [Container(identity) for identity in identities]
        numbers = [(await each.inspect())["Config"]["Labels"]["com.docker.compose.container-number"] for each in found]
        return [each for _, each in sorted(zip(map(int, numbers), found, strict=True), key=lambda pair: pair[0])]

    async def one(self, service: str) -> Container:
        """The only container of a service."""
        (found,) = await self.all(service)
        return found

    async def compose(self, *words: str, fails: str | None = None) -> str:
        """What a command of `docker compose` prints; `fails` is what it must say if it has to fail."""
        return await said(*self._compose, *words, fails=fails)

    async def scale(self, service: str, number: int) -> None:
        """Have so many containers of a service, all healthy, and leave the others alone."""
        await self.compose("up", "--detach", "--no-recreate", "--wait", "--scale", f"{service}={number}", service)

    async def python(self, service: str, code: str, *words: str) -> str:
        """What a piece of Python prints in a service's container."""
        return await (await self.one(service)).python(code, *words)

    async def inspect(self, service: str) -> dict[str, Any]:
        """What Docker knows of a service's container."""
        return await (await self.one(service)).inspect()

    async def restarts(self, service: str) -> int:
        """How often the restart policy brought the service back."""
        return int((await self.inspect(service))["RestartCount"])

    async def log(self, service: str) -> str:
        """All that it has said."""
        return await self.compose("logs", "--no-log-prefix", service)

    async def workers(self, service: str) -> list[tuple[int, int]]:
        """The processes that do what a service's container is for, the one that works first; another stands by."""
        return await (await self.one(service)).workers()

    async def quiet(self, service: str) -> None:
        """Wait until its container has run long enough for the next death to be the first in a row, and until another
        process stands by."""
        while True:
            started = str((await self.inspect(service))["State"]["StartedAt"])[:19]  # to the second, UTC
            since = dt.datetime.now(dt.UTC) - dt.datetime.fromisoformat(f"{started}+00:00")
            settled = since.total_seconds() > QUIET_SECONDS
            if settled and time.monotonic() - self.fault_at > QUIET_SECONDS and len(await self.workers(service)) > 1:
                return
            await asyncio.sleep(0.5)

    async def kill(self, service: str, number: signal.Signals = signal.SIGKILL) -> None:
        """Send a signal to the process that does what a service's container is for."""
        _, process = (await self.workers(service))[0]
        self.fault_at = time.monotonic()
        await self.python(service, KILL, str(process), str(number.value))

    async def kill_all(self, service: str) -> None:
        """SIGKILL to all that a service's container runs, by its own user: nothing there may do more."""
        self.fault_at = time.monotonic()
        with contextlib.suppress(CommandError):  # which may be killed with the container
            await self.python(service, KILL_ALL, service)

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


async def said(*command: str, fails: str | None = None) -> str:
    """What a command prints. CommandError if it ends with another code than 0; or, where it has to fail, with 0, or
    without having said `fails`."""
    errors = None if fails is None else asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*command, stdout=asyncio.subprocess.PIPE, stderr=errors)
    printed, told = await process.communicate()
    if fails is None and process.returncode != 0:
        raise CommandError(f"{' '.join(command)} ended with code {process.returncode}")
    if fails is not None and (process.returncode == 0 or fails not in told.decode()):
        raise CommandError(
            f"{' '.join(command)} was to say {fails!r}, ended with {process.returncode}: {told.decode()}"
        )
    return printed.decode()
