"""A viewer that stays: it connects again whenever its stream breaks, and keeps what it saw and when."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import ssl
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Ack, Resize, Snapshot, notice

SIZES = ((320, 180), (336, 189))
"""In turn, so that frames come of a stone at rest too, and a pause in them means something."""
STIR_SECONDS = 0.1
CONNECT_AGAIN_SECONDS = 0.1
JOIN_SECONDS = 30.0
OPEN_SECONDS = 5.0


@dataclass
class Watcher:
    """What came."""

    url: str
    context: ssl.SSLContext | None = None
    """For wss: whom to believe."""
    frames: list[tuple[float, Frame]] = field(default_factory=list)
    """With `time.monotonic` at arrival; without their pictures."""

    def frames_since(self, moment: float) -> list[tuple[float, Frame]]:
        """Those that arrived later."""
        return [(at, frame) for at, frame in self.frames if at > moment]

    def seconds_to_frames(self, fault: float) -> float:
        """From the fault to the end of the longest pause in frames that came of it."""
        times = [fault, *(at for at, _ in self.frames_since(fault))]
        return max(itertools.pairwise(times), key=lambda pair: pair[1] - pair[0])[1] - fault

    async def run(self) -> None:
        """Watch for ever."""
        while True:
            with contextlib.suppress(OSError, WebSocketException, TimeoutError):
                await self._watch()
            await asyncio.sleep(CONNECT_AGAIN_SECONDS)

    async def _watch(self) -> None:
        async with connected(self.url, self.context) as socket:
            stirring = asyncio.create_task(_stir(socket))
            try:
                async for message in socket:
                    if isinstance(message, bytes):
                        frame = Frame.unpack(message)
                        self.frames.append((time.monotonic(), replace(frame, payload=b"")))
                        await socket.send(Ack(sequence=frame.sequence).model_dump_json())
            finally:
                stirring.cancel()


@asynccontextmanager
async def watching(url: str, context: ssl.SSLContext | None = None) -> AsyncIterator[Watcher]:
    """A watcher of the session that is streamed there."""
    watcher = Watcher(url, context)
    task = asyncio.create_task(watcher.run())
    try:
        yield watcher
    finally:
        task.cancel()


async def first_snapshot(url: str) -> dict[str, Any]:
    """What a viewer that joins is told."""
    async with asyncio.timeout(JOIN_SECONDS), connected(url) as socket:
        async for message in socket:
            if isinstance(message, str) and isinstance(told := notice.validate_json(message), Snapshot):
                return told.snapshot
    raise SystemExit("the stream ended without a snapshot")


def connected(url: str, context: ssl.SSLContext | None = None, *protocols: str) -> connect:
    """A stream; `protocols` are others that the page offers besides."""
    offered = [Subprotocol(SUBPROTOCOL), *map(Subprotocol, protocols)]
    return connect(url, ssl=context, subprotocols=offered, max_size=None, compression=None, open_timeout=OPEN_SECONDS)


async def _stir(socket: ClientConnection) -> None:
    for width, height in itertools.cycle(SIZES):
        with contextlib.suppress(WebSocketException):
            await socket.send(Resize(width=width, height=height).model_dump_json())
        await asyncio.sleep(STIR_SECONDS)
