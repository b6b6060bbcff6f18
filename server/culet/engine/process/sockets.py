"""The engine's two ZeroMQ sockets: ROUTER for control, XPUB for frames."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

import zmq
import zmq.asyncio

from culet.endpoints import bind, keep_alive
from culet_protocol.engine import REQUEST_NUMBER
from culet_protocol.keys import EngineKeys

log = logging.getLogger(__name__)

FRAMES_HIGH_WATER = 2
"""Frames that wait for one subscriber; further ones are dropped until it takes some."""
PEERS = 64
"""Gateways that are told things unasked."""
JSON_BYTES = 2**20


def bind_control(
    context: zmq.asyncio.Context, endpoint: str, upload_bytes: int, keys: EngineKeys | None = None
) -> zmq.asyncio.Socket:
    """The ROUTER; a longer message than an upload needs ends its sender's connection."""
    socket = context.socket(zmq.ROUTER)
    socket.setsockopt(zmq.MAXMSGSIZE, upload_bytes + JSON_BYTES)
    socket.setsockopt(zmq.ROUTER_MANDATORY, 1)  # a peer that left is an error, by which it is forgotten
    return _bind(socket, [endpoint], "control", keys)


def bind_frames(
    context: zmq.asyncio.Context, endpoints: Sequence[str], keys: EngineKeys | None = None
) -> zmq.asyncio.Socket:
    """The XPUB, at each of the endpoints: every new subscription is seen, and, once nobody has it any more, its end."""
    socket = context.socket(zmq.XPUB)
    socket.setsockopt(zmq.XPUB_VERBOSE, 1)
    socket.setsockopt(zmq.SNDHWM, FRAMES_HIGH_WATER)  # before bind, or it has no effect
    socket.setsockopt(zmq.MAXMSGSIZE, 1024)  # subscriptions are short
    return _bind(socket, endpoints, "frames", keys)


def _bind(
    socket: zmq.asyncio.Socket, endpoints: Sequence[str], option: str, keys: EngineKeys | None
) -> zmq.asyncio.Socket:
    socket.setsockopt(zmq.LINGER, 0)
    keep_alive(socket)  # and not ZeroMQ's heartbeats, which can end a process: see gateway.link
    for endpoint in endpoints:
        if keys is not None:
            keys.apply(socket, endpoint)
        bind(socket, endpoint, option)
    return socket


class Peers:
    """Who is on the other side of the ROUTER: those who asked something, and those who only connected."""

    def __init__(self, socket: zmq.asyncio.Socket, left: Callable[[bytes], None] = lambda _: None) -> None:
        """`left` is told of a peer that is gone, when it is next to be told something."""
        self._socket = socket
        self._left = left
        self._asking: dict[bytes, None] = {}
        self._connected: dict[bytes, None] = {}

    def __bool__(self) -> bool:
        return bool(self._asking or self._connected)

    def heard_from(self, peer: bytes, *, asks: bool) -> None:
        """Remember that it exists. Of each kind PEERS are told things unasked, so that whoever only connects can never
        push out a gateway that works; the one heard from longest ago is forgotten first."""
        if asks:
            self._connected.pop(peer, None)
        elif peer in self._asking:
            return
        kind = self._asking if asks else self._connected
        kind.pop(peer, None)
        kind[peer] = None
        while len(kind) > PEERS:
            del kind[next(iter(kind))]

    async def tell(self, message: bytes) -> None:
        """Send to every peer what nobody asked for."""
        for peer in [*self._asking, *self._connected]:
            await self.send(peer, [REQUEST_NUMBER.pack(0), message])

    async def send(self, peer: bytes, parts: list[bytes]) -> None:
        """Send to one; one that left is forgotten, one that takes nothing any more (1000 messages wait) misses this."""
        try:
            await self._socket.send_multipart([peer, *parts], flags=zmq.NOBLOCK, copy=False)  # of large stills
        except zmq.Again:
            log.warning("a peer takes no messages: dropped one of %d bytes", sum(map(len, parts)))
        except zmq.ZMQError:
            self._asking.pop(peer, None)
            self._connected.pop(peer, None)
            self._left(peer)
