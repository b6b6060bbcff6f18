"""What sessions and viewers cost: a real `culet serve`, its sessions' cameras turning, and viewers that look on."""

from __future__ import annotations

import asyncio
import contextlib
import json
import statistics
import sys
import tempfile
import time
import urllib.request
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urljoin

from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from culet.errors import CuletError
from culet.study.serving.governor_study import processor_seconds
from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Ack, Orbit, Resize

WIDTH, HEIGHT = 160, 90
"""Pixels of each picture: few, so that many sessions hold their rate."""
TURNS = 5.0
"""A second, of each session's camera: as many frames are drawn, however many look on."""
TURN = 0.05
"""rad."""
POLL_SECONDS = 0.05
READY = "culet is ready: "
START_SECONDS = 60.0
SETTLE_SECONDS = 1.5
"""Before what is measured: programs are there, pictures are as large as was asked for."""


class Load(NamedTuple):
    """Of a service."""

    processor_seconds: float
    """Of all its processes that last, in a second of the clock."""
    frames: float
    """That came to a viewer, in a second of the clock: the mean of all."""


class Service:
    """A running `culet serve`."""

    def __init__(self, process: int, url: str) -> None:
        self._process, self._url = process, url

    async def load(self, sessions: int, viewers: int, seconds: float) -> Load:
        """Of so many sessions with so many viewers each, for so long."""
        opened = [await asyncio.to_thread(self._open) for _ in range(sessions)]
        try:
            async with AsyncExitStack() as stack:
                crowds = [
                    [await stack.enter_async_context(_connected(stream)) for _ in range(viewers)]
                    for stream in (urljoin(f"{self._url}/api/sessions", each["stream"]) for each in opened)
                ]
                return await self._measured(crowds, seconds)
        finally:
            for each in opened:
                await asyncio.to_thread(self._request, "DELETE", f"/api/sessions/{each['id']}")

    async def _measured(self, crowds: list[list[ClientConnection]], seconds: float) -> Load:
        counts = [0] * sum(map(len, crowds))
        everyone = [viewer for crowd in crowds for viewer in crowd]
        tasks = [asyncio.create_task(_look_on(viewer, counts, number)) for number, viewer in enumerate(everyone)]
        tasks += [asyncio.create_task(_turn(crowd[0])) for crowd in crowds]
        try:
            await _until_all_saw(tasks, counts, SETTLE_SECONDS)
            before, began = self._spent(), time.perf_counter()
            counts[:] = [0] * len(counts)
            await _until_all_saw(tasks, counts, seconds)
            lasted, after = time.perf_counter() - began, self._spent()
            spent = sum(after[process] - before[process] for process in before.keys() & after)
            return Load(spent / lasted, statistics.fmean(counts) / lasted)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    def _open(self) -> dict[str, str]:
        answer: dict[str, str] = json.loads(self._request("POST", "/api/sessions"))
        return answer

    def _request(self, method: str, path: str) -> bytes:
        request = urllib.request.Request(self._url + path, method=method)  # noqa: S310 - of the service that runs here
        with urllib.request.urlopen(request, timeout=START_SECONDS) as answer:  # noqa: S310
            body: bytes = answer.read()
        return body

    def _spent(self) -> dict[int, float]:
        """s of the processor by process. One that compiles may end meanwhile, and does not count."""
        found = {}
        for process in family_of(self._process):
            with contextlib.suppress(OSError):
                found[process] = processor_seconds(process)
        return found


@asynccontextmanager
async def running_service() -> AsyncIterator[Service]:
    """`culet serve` on a free port of loopback. CuletError if it does not come up."""
    with tempfile.TemporaryFile() as messages:
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "culet", "serve", "--port", "0", stdout=asyncio.subprocess.PIPE, stderr=messages
        )
        assert process.stdout is not None  # noqa: S101 - it is a pipe
        try:
            line = b""
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(START_SECONDS):
                    line = await process.stdout.readline()
            if not line.startswith(READY.encode()):
                messages.seek(0)
                raise CuletError(f"expected `culet serve` to come up, got {line + messages.read()[-500:]!r}")
            yield Service(process.pid, line.decode().removeprefix(READY).strip().rstrip("/"))
        finally:
            with contextlib.suppress(ProcessLookupError):
                process.terminate()
            await process.wait()


@asynccontextmanager
async def _connected(url: str) -> AsyncIterator[ClientConnection]:
    """A viewer that has said how large its picture is."""
    async with connect(
        "ws" + url.removeprefix("http"), subprotocols=[Subprotocol(SUBPROTOCOL)], compression=None
    ) as viewer:
        await viewer.send(Resize(width=WIDTH, height=HEIGHT).model_dump_json())
        yield viewer


async def _look_on(viewer: ClientConnection, counts: list[int], number: int) -> None:
    """Take frames, and count them at that place."""
    async for message in viewer:
        if isinstance(message, bytes):
            await viewer.send(Ack(sequence=Frame.unpack(message).sequence).model_dump_json())
            counts[number] += 1


async def _turn(viewer: ClientConnection) -> None:
    """Turn its session's camera, for ever."""
    event = Orbit(target="camera", yaw=TURN, pitch=0).model_dump_json()
    while True:
        await viewer.send(event)
        await asyncio.sleep(1 / TURNS)


async def _until_all_saw(tasks: list[asyncio.Task[None]], counts: list[int], seconds: float) -> None:
    """Wait so long, and on until every viewer has had a frame: programs may have to be compiled first. CuletError if
    one has none for START_SECONDS."""
    await _unless_ended(tasks, seconds)
    late = time.perf_counter() + START_SECONDS
    while min(counts) == 0:
        if time.perf_counter() > late:
            raise CuletError(f"expected a frame for each viewer within {START_SECONDS:g} s, got none for one of them")
        await _unless_ended(tasks, POLL_SECONDS)


async def _unless_ended(tasks: list[asyncio.Task[None]], seconds: float) -> None:
    """Wait so long; CuletError if one of these ends before."""
    done, _ = await asyncio.wait(tasks, timeout=seconds, return_when=asyncio.FIRST_COMPLETED)
    for task in done:
        raise CuletError("expected streams that stay open, one ended") from task.exception()


def family_of(process: int) -> list[int]:
    """A process and all that descend from it (proc(5): children of each thread)."""
    found = [process]
    for file in Path(f"/proc/{process}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            for child in file.read_text(encoding="utf-8").split():
                found += family_of(int(child))
    return found
