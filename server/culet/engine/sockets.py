"""The engine's two ZeroMQ sockets: ROUTER for control, XPUB for frames."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import zmq
import zmq.asyncio

from culet.endpoints import bind
from culet_protocol.engine import REQUEST_NUMBER

log = logging.getLogger(__name__)

FRAMES_HIGH_WATER = 2
"""Frames that wait for one subscriber; further ones are dropped until it takes some."""
PEERS = 64
"""Gateways that are told things unasked; the one heard from longest ago is forgotten first."""
HEARTBEAT_MS = 2000
"""Between ZeroMQ's own probes on tcp, which find peers that vanished without a word."""
JSON_BYTES = 2**20


def bind_control(context: zmq.asyncio.Context, endpoint: str, upload_bytes: int) -> zmq.asyncio.Socket:
    """The ROUTER; a longer message than an upload needs ends its sender's connection."""
    socket = context.socket(zmq.ROUTER)
    socket.setsockopt(zmq.MAXMSGSIZE, upload_bytes + JSON_BYTES)
    socket.setsockopt(zmq.ROUTER_MANDATORY, 1)  # a peer that left is an error, by which it is forgotten
    return _bind(socket, [endpoint], "control")


def bind_frames(context: zmq.asyncio.Context, endpoints: Sequence[str]) -> zmq.asyncio.Socket:
    """The XPUB, at each of the endpoints: every new subscription is seen, and, once nobody has it any more, its end."""
    socket = context.socket(zmq.XPUB)
    socket.setsockopt(zmq.XPUB_VERBOSE, 1)
    socket.setsockopt(zmq.SNDHWM, FRAMES_HIGH_WATER)  # before bind, or it has no effect
    socket.setsockopt(zmq.MAXMSGSIZE, 1024)  # subscriptions are short
    return _bind(socket, endpoints, "frames")


def _bind(socket: zmq.asyncio.Socket, endpoints: Sequence[str], option: str) -> zmq.asyncio.Socket:
    socket.setsockopt(zmq.LINGER, 0)
    if any(endpoint.startswith("tcp:") for endpoint in endpoints):
        socket.setsockopt(zmq.HEARTBEAT_IVL, HEARTBEAT_MS)
        socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 2 * HEARTBEAT_MS)
        socket.setsockopt(zmq.HEARTBEAT_TTL, 3 * HEARTBEAT_MS)
    for endpoint in endpoints:
        bind(socket, endpoint, option)
    return socket


class Peers:
    """Who is on the other side of the ROUTER, the one heard from last at the end."""

    def __init__(self, socket: zmq.asyncio.Socket) -> None:
        self._socket = socket
        self._peers: dict[bytes, None] = {}

    def heard_from(self, peer: bytes) -> None:
        """Remember that it exists."""
        self._peers.pop(peer, None)
        self._peers[peer] = None
        while len(self._peers) > PEERS:
            del self._peers[next(iter(self._peers))]

    async def tell(self, message: bytes) -> None:
        """Send to every peer what nobody asked for."""
        for peer in list(self._peers):
            await self.send(peer, [REQUEST_NUMBER.pack(0), message])

    async def send(self, peer: bytes, parts: list[bytes]) -> None:
        """Send to one; one that left is forgotten, one that takes nothing any more (1000 messages wait) misses this."""
        try:
            await self._socket.send_multipart([peer, *parts], flags=zmq.NOBLOCK)
        except zmq.Again:
            log.warning("a peer takes no messages: dropped one of %d bytes", sum(map(len, parts)))
        except zmq.ZMQError:
            self._peers.pop(peer, None)
