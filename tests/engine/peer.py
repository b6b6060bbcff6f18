"""A real engine process on sockets of its own, and a peer that speaks to it as the gateway does."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import zmq
import zmq.asyncio

from culet_protocol.engine import REQUEST_NUMBER
from culet_protocol.frame import Frame
from culet_protocol.watch import watch_key
from shared import patience

PATIENCE = patience.PATIENCE
SIZE: dict[str, Any] = {"width": 64, "height": 36}

TETRAHEDRON = b"OFF\n4 4 0\n1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n"


@dataclass
class EngineProcess:
    """A running `culet engine`."""

    process: subprocess.Popen[bytes]
    control: str
    frames: str


@contextmanager
def running_engine(folder: Path) -> Iterator[EngineProcess]:
    """Start an engine; end it."""
    control, frames = f"ipc://{folder}/control", f"ipc://{folder}/frames"
    command = [sys.executable, "-m", "culet", "engine", "--control", control, "--frames", frames]
    process = subprocess.Popen(command)
    try:
        yield EngineProcess(process, control, frames)
    finally:
        process.terminate()
        try:
            process.wait(PATIENCE)
        finally:
            process.kill()  # one that outlived the tests would keep whoever reads their output waiting
            process.wait()


class Peer:
    """What the gateway is to an engine."""

    def __init__(self, context: zmq.asyncio.Context, control: str) -> None:
        self.unasked: list[dict[str, Any]] = []
        self.session = ""
        self._socket = context.socket(zmq.DEALER)
        self._socket.setsockopt(zmq.LINGER, 0)
        self._socket.setsockopt(zmq.PROBE_ROUTER, 1)
        self._socket.connect(control)
        self.number = 0
        """Of the request asked last."""
        self._replies: dict[int, asyncio.Future[tuple[dict[str, Any], bytes | None]]] = {}
        self._told = asyncio.Condition()
        self.reader = asyncio.create_task(self._read())

    async def raw(self, *parts: bytes) -> None:
        """Send whatever."""
        await self._socket.send_multipart(parts)

    def ask_later(
        self,
        data: bytes | None = None,
        **request: Any,  # noqa: ANN401
    ) -> asyncio.Future[tuple[dict[str, Any], bytes | None]]:
        """Send a request; the reply and its bytes come."""
        self.number += 1
        reply: asyncio.Future[tuple[dict[str, Any], bytes | None]] = asyncio.get_running_loop().create_future()
        self._replies[self.number] = reply
        parts = [REQUEST_NUMBER.pack(self.number), json.dumps(request).encode()]
        self._socket.send_multipart(parts if data is None else [*parts, data])
        return reply

    async def ask(self, data: bytes | None = None, **request: Any) -> dict[str, Any]:  # noqa: ANN401
        """The reply to a request, whatever its status."""
        async with asyncio.timeout(PATIENCE):
            return (await self.ask_later(data, **request))[0]

    async def result(self, data: bytes | None = None, **request: Any) -> dict[str, Any]:  # noqa: ANN401
        """The result of a request that must succeed."""
        reply = await self.ask(data, **request)
        assert reply["status"] == 200, reply
        result: dict[str, Any] = reply["result"]
        return result

    async def open(self, scene: dict[str, Any] | None = None, **more: Any) -> str:  # noqa: ANN401
        """A new session."""
        self.session = os.urandom(16).hex()
        await self.result(type="open_session", session=self.session, scene=scene or {}, **more)
        return self.session

    async def control(self, event: str, **values: Any) -> dict[str, Any]:  # noqa: ANN401
        """The reply to an event for the session opened last."""
        return await self.ask(type="control", session=self.session, event={"type": event} | values)

    async def demand(self, frames_per_second: float = 60, **size: int) -> None:
        """Say what the viewers of the session opened last can take."""
        size = SIZE | size
        await self.result(
            type="demand",
            session=self.session,
            frames_per_second=frames_per_second,
            width=size["width"],
            height=size["height"],
        )

    async def status(self) -> dict[str, Any]:
        """The engine's counters."""
        return await self.result(type="status")

    async def status_of_session(self) -> dict[str, Any]:
        """What there is to know of the session opened last."""
        return await self.result(type="get_session", session=self.session)

    async def told(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The first message told unasked that fits, now or later."""
        async with asyncio.timeout(PATIENCE), self._told:
            while True:
                for message in self.unasked:
                    if wanted(message):
                        return message
                await self._told.wait()

    async def _read(self) -> None:
        while True:
            parts = await self._socket.recv_multipart()
            (number,) = REQUEST_NUMBER.unpack(parts[0])
            message = json.loads(parts[1])
            if number in self._replies:
                self._replies.pop(number).set_result((message, parts[2] if len(parts) > 2 else None))
            else:
                async with self._told:
                    self.unasked.append(message)
                    self._told.notify_all()


class Watcher:
    """A subscriber to one session's frames."""

    def __init__(self, context: zmq.asyncio.Context, frames: str, session: str) -> None:
        self.topic = watch_key(session)
        self._socket = context.socket(zmq.SUB)
        self._socket.setsockopt(zmq.LINGER, 0)
        self._socket.subscribe(self.topic)
        self._socket.connect(frames)

    async def next(self) -> Frame:
        """The next frame."""
        async with asyncio.timeout(PATIENCE):
            return Frame.unpack(await self._socket.recv())

    async def until(self, wanted: Callable[[Frame], bool]) -> Frame:
        """The next frame that fits."""
        async with asyncio.timeout(PATIENCE):  # of all together: a picture at rest is sent again for ever
            while not wanted(frame := await self.next()):
                pass
        return frame

    def leave(self) -> None:
        """Stop watching."""
        self._socket.close()


@contextmanager
def watching(context: zmq.asyncio.Context, frames: str) -> Iterator[Callable[[str], Watcher]]:
    """A way to watch. All watchers leave at the end: ZeroMQ warns of one that its test let go of while it watched."""
    with ExitStack() as watchers:

        def watch(session: str) -> Watcher:
            watcher = Watcher(context, frames, session)
            watchers.callback(watcher.leave)
            return watcher

        yield watch


@asynccontextmanager
async def connected(engine: EngineProcess) -> AsyncIterator[tuple[Peer, Callable[[str], Watcher]]]:
    """A peer, and a way to watch."""
    context = zmq.asyncio.Context()
    peer = Peer(context, engine.control)
    try:
        with watching(context, engine.frames) as watch:
            yield peer, watch
    finally:
        peer.reader.cancel()
        await asyncio.gather(peer.reader, return_exceptions=True)
        context.destroy(linger=0)
