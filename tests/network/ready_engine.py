"""Stands in for the engine: sends frames of the default scene that were drawn before, of the size and quality that the
engine's own thrift chooses, so that the link alone decides how many come. ready_engine.py CONTROL FRAMES
"""

from __future__ import annotations

import asyncio
import json
import sys
import time
from dataclasses import dataclass
from functools import cache

import numpy as np
import zmq
import zmq.asyncio

from culet.engine.governing.thrift import ByteAllowance, Thrift, read_byte_ladder
from culet.engine.painting import jpeg
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.engine import REQUEST_NUMBER
from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.messages import BALANCED, Condition, balance_rate
from culet_protocol.sizes import LIVE_SIZE
from culet_protocol.watch import watch_key

ASKED = balance_rate(BALANCED)


class Pictures:
    """Of the default scene, one sample a pixel, by size and quality."""

    def __init__(self) -> None:
        self._renderer, self._stage = Renderer(), Stage.of(Scene())
        for scale in read_byte_ladder().scales:
            self.drawn(round(LIVE_SIZE[0] * scale), round(LIVE_SIZE[1] * scale))

    @cache  # noqa: B019 - there is one
    def drawn(self, width: int, height: int) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
        picture = self._renderer.picture(self._stage, width, height)
        picture.refine()
        return picture.rgb()

    @cache  # noqa: B019 - as above
    def encoded(self, width: int, height: int, quality: int) -> bytes:
        return jpeg.encode(self.drawn(width, height), quality)


@dataclass
class Shown:
    """One session."""

    key: bytes
    thrift: Thrift
    rate: float = 0.0
    allowance: ByteAllowance = ByteAllowance()  # noqa: RUF009 - immutable
    size: tuple[int, int] = LIVE_SIZE
    sequence: int = 0
    due_at: float = 0.0

    def frame(self, pictures: Pictures) -> bytes:
        """The next one."""
        room = self.allowance.room(ASKED, ASKED)
        width, height, quality = *self.size, jpeg.MOVING_QUALITY
        if room is not None:
            scale = self.thrift.scale(self.size, room)
            width, height = round(width * scale), round(height * scale)
            quality = self.thrift.encoding((width, height), room).quality
        payload = pictures.encoded(width, height, quality)
        self.thrift.encoded((width, height), quality, len(payload))
        self.sequence += 1
        return Frame(
            self.key, Codec.JPEG, Flags.MOVING | Flags.KEY, self.sequence, width, height, 1, 3, 64, 0.01, self.sequence,
            0.0, time.time(), 0.0, 0.0, 0.0, 0.0, 0.0, payload,
        ).pack()  # fmt: skip


async def serve(control: str, frames: str) -> None:
    """Until killed."""
    pictures, sessions = Pictures(), dict[str, Shown]()
    peers: set[bytes] = set()
    watched: set[bytes] = set()
    context = zmq.asyncio.Context()
    router, publisher = context.socket(zmq.ROUTER), context.socket(zmq.XPUB)
    publisher.setsockopt(zmq.SNDHWM, 2)
    router.bind(control)
    publisher.bind(frames)
    heartbeat = json.dumps({"type": "heartbeat", "instance": "ready"}).encode()

    def answer(request: dict[str, object]) -> dict[str, object]:
        match request["type"]:
            case "open_session":
                session = str(request["session"])
                sessions[session] = Shown(watch_key(session), Thrift(read_byte_ladder()))
                described = {"scene": request["scene"], "revision": 1, "snapshot": None, "findings": []}
                return described | {"watched": False} | Condition(falling=True).model_dump()
            case "list_sessions":
                return {"sessions": {}}
            case "demand":
                shown = sessions[str(request["session"])]
                shown.rate = float(str(request["frames_per_second"]))
                shown.size = int(str(request["width"])), int(str(request["height"]))
                numbers = (request["bytes_per_frame"], request["bytes_at_rest"])
                shown.allowance = ByteAllowance(*(None if number is None else int(str(number)) for number in numbers))
        return {}

    async def beat() -> None:
        while True:
            for peer in list(peers):
                await router.send_multipart([peer, REQUEST_NUMBER.pack(0), heartbeat])
            await asyncio.sleep(0.5)

    async def requests() -> None:
        while True:
            peer, *parts = await router.recv_multipart()
            peers.add(peer)
            if len(parts) < 2:
                await router.send_multipart([peer, REQUEST_NUMBER.pack(0), heartbeat])
                continue
            reply = {"type": "reply", "result": answer(json.loads(parts[1]))}
            await router.send_multipart([peer, parts[0], json.dumps(reply).encode()])

    async def subscriptions() -> None:
        while True:
            message = await publisher.recv()
            (watched.add if message[0] else watched.discard)(message[1:])

    async def draw() -> None:
        while True:
            await asyncio.sleep(0.002)
            now = time.monotonic()
            for shown in sessions.values():
                if shown.key in watched and shown.rate > 0 and now >= shown.due_at:
                    shown.due_at = max(shown.due_at + 1 / min(ASKED, shown.rate), now)
                    await publisher.send(shown.frame(pictures))

    await asyncio.gather(beat(), requests(), subscriptions(), draw())


if __name__ == "__main__":
    asyncio.run(serve(*sys.argv[1:]))
