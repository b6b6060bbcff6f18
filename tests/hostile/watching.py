"""Viewers that watch as the page does, and keep count of what they see."""

from __future__ import annotations

import asyncio
import contextlib
import json
import time
from collections.abc import AsyncIterator
from itertools import pairwise
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Flags, Frame
from hostile.serving import PATIENCE, Serving

PAUSE = 0.1
"""s before a viewer that was cut off tries again; the page begins with as much."""
SOON = 1.0
"""s within which the death of a process shows, if it shows at all."""


class Watcher:
    """One viewer. It acknowledges every frame, and comes back when it is cut off."""

    def __init__(self, serving: Serving, session: str, size: tuple[int, int]) -> None:
        self.session = session
        self.seen: list[tuple[float, int]] = []
        """When (s, monotonic) which frame came."""
        self.rests = False
        """Whether the last of them is the final one of a picture at rest: no new one comes."""
        self.notices: list[dict[str, Any]] = []
        self.closes: list[str] = []
        self._url = f"{serving.stream_url}/api/sessions/{session}/stream"
        self._size = {"type": "resize", "width": size[0], "height": size[1]}
        self._connection: ClientConnection | None = None

    async def watch(self) -> None:
        """For ever; cancel it."""
        while True:
            try:
                async with connect(
                    self._url, subprotocols=[Subprotocol(SUBPROTOCOL)], max_size=None, compression=None, proxy=None
                ) as self._connection:
                    await self.say(self._size)
                    async for message in self._connection:
                        await self._take(message)
                self.closes.append(f"{self._connection.close_code} {self._connection.close_reason}")
            except (OSError, TimeoutError, WebSocketException) as error:
                self.closes.append(f"{type(error).__name__}: {error}")
            await asyncio.sleep(PAUSE)

    async def say(self, message: dict[str, Any]) -> None:
        """A control event."""
        assert self._connection
        await self._connection.send(json.dumps(message))

    def rate(self, began: float, ended: float) -> float:
        """Frames a second between two times."""
        return sum(began <= at < ended for at, _ in self.seen) / (ended - began)

    def longest_gap(self, began: float, ended: float) -> float:
        """s between two frames."""
        times = [began, *(at for at, _ in self.seen if began <= at < ended), ended]
        return max(after - before for before, after in pairwise(times))

    async def frame_after(self, moment: float, patience: float = PATIENCE) -> float:
        """s from that moment to the first frame that came later."""
        async with asyncio.timeout(patience):
            while not self.seen or self.seen[-1][0] <= moment:  # noqa: ASYNC110 - the condition is the server's
                await asyncio.sleep(0.005)
        return next(at for at, _ in self.seen if at > moment) - moment

    async def rest(self, patience: float = PATIENCE) -> None:
        """Wait until the picture is as good as it becomes."""
        async with asyncio.timeout(patience):
            while not self.rests:  # noqa: ASYNC110 - the condition is the server's
                await asyncio.sleep(0.005)

    async def pause_after(self, moment: float) -> float:
        """s of the longest pause that began within SOON after that moment, once frames come again."""
        await self.frame_after(moment + SOON)
        return self.longest_gap(moment, self.seen[-1][0])

    async def _take(self, message: str | bytes) -> None:
        if isinstance(message, str):
            self.notices.append(json.loads(message))
            return
        frame = Frame.unpack(message)
        self.seen.append((time.monotonic(), frame.sequence))
        self.rests = Flags.FINAL in frame.flags
        await self.say({"type": "ack", "sequence": frame.sequence})


@contextlib.asynccontextmanager
async def watching(
    serving: Serving, sessions: list[str], size: tuple[int, int] = (320, 180)
) -> AsyncIterator[list[Watcher]]:
    """A viewer of each of these, once it has had a frame."""
    watchers = [Watcher(serving, session, size) for session in sessions]
    tasks = [asyncio.create_task(watcher.watch()) for watcher in watchers]
    try:
        for watcher in watchers:
            await watcher.frame_after(0)
        yield watchers
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
