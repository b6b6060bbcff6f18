"""Frames of a WebSocket that no message comes of, by a client that speaks the protocol byte by byte."""

from __future__ import annotations

import asyncio
import base64
import os
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any
from urllib.parse import urlsplit

import pytest
import uvicorn
from uvicorn.server import ServerState
from websockets.frames import Frame

from culet.gateway.connections.paced_stream import FRAMES_PER_SECOND, PIECE, UNSENT_BYTES, PacedStream
from culet.gateway.limits.bucket import BURST_SECONDS
from culet_protocol import SUBPROTOCOL
from gateway.running import PATIENCE, Gateway

MASK = bytes(4)
PING = b"\x89\xfd" + MASK + bytes(125)
PONG = b"\x8a\x80" + MASK
EMPTY_FRAGMENT = b"\x00\x80" + MASK
EMPTY_TEXT = b"\x81\x80" + MASK
BURST = int(FRAMES_PER_SECOND * BURST_SECONDS)
BEGIN_OF_TEXT = b"\x01\x80" + MASK
HELD = 24 << 20
"""Bytes. The system's own buffers, of both ends of a connection, hold less."""


@asynccontextmanager
async def raw_stream(gateway: Gateway, session: str) -> AsyncIterator[socket.socket]:
    """A stream's socket after its handshake."""
    loop, address = asyncio.get_running_loop(), urlsplit(gateway.url)
    key = base64.b64encode(os.urandom(16)).decode()
    head = (
        f"GET /api/sessions/{session}/stream HTTP/1.1\r\nHost: {address.netloc}\r\nConnection: Upgrade\r\n"
        f"Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
        f"Sec-WebSocket-Protocol: {SUBPROTOCOL}\r\n\r\n"
    )
    with socket.socket() as connection:
        connection.setblocking(False)
        await loop.sock_connect(connection, (address.hostname, address.port))
        await loop.sock_sendall(connection, head.encode())
        received = b""
        async with asyncio.timeout(PATIENCE):
            while b"\r\n\r\n" not in received:
                received += await loop.sock_recv(connection, 1)
        assert b" 101 " in received
        yield connection


async def sent(connection: socket.socket, frame: bytes, limit: int) -> int:
    """Send a frame again and again, to the limit in bytes or until the other end takes no more; the bytes that went."""
    loop, block, total = asyncio.get_running_loop(), frame * (65536 // len(frame)), 0
    while total < limit:
        try:
            async with asyncio.timeout(1):
                await loop.sock_sendall(connection, block)
        except TimeoutError:
            break
        total += len(block)
    return total


async def test_pings_whose_answers_nobody_reads_wait_at_their_sender_and_delay_nobody(
    gateway: Gateway,
) -> None:
    session = await gateway.session()
    async with raw_stream(gateway, session) as connection, gateway.viewer(session) as other:
        flooding = asyncio.create_task(sent(connection, PING, HELD))
        await other.final()
        async with asyncio.timeout(PATIENCE):
            assert await flooding < HELD


class Connection(asyncio.Transport):
    """A connection that knows whether it is being read."""

    reading = True
    written = b""

    def pause_reading(self) -> None:
        self.reading = False

    def resume_reading(self) -> None:
        self.reading = True

    def is_closing(self) -> bool:
        return False

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self.written += bytes(data)

    def close(self) -> None: ...


class Counted(PacedStream):
    """Counts the frames that it takes apart."""

    counted = 0

    def handle_pong(self, event: Frame) -> None:
        self.counted += 1
        super().handle_pong(event)

    def handle_cont(self, event: Frame) -> None:
        self.counted += 1
        super().handle_cont(event)

    def handle_text(self, event: Frame) -> None:
        self.counted += 1
        super().handle_text(event)


@asynccontextmanager
async def served(line: socket.socket | None = None) -> AsyncIterator[tuple[Counted, Connection]]:
    """A stream of an application that takes nothing, after its handshake; of that socket, if it asks for one."""
    accepted, over = asyncio.Event(), asyncio.Event()

    async def app(_scope: object, receive: Callable[[], Any], send: Callable[[Any], Any]) -> None:
        await receive()
        await send({"type": "websocket.accept"})
        accepted.set()
        await over.wait()

    stream, connection = (
        Counted(uvicorn.Config(app, ws_ping_interval=None), ServerState(), {}),
        Connection({"socket": line}),
    )
    stream.connection_made(connection)
    head = "GET / HTTP/1.1\r\nHost: a\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    stream.data_received(f"{head}Sec-WebSocket-Key: {base64.b64encode(bytes(16)).decode()}\r\n\r\n".encode())
    async with asyncio.timeout(PATIENCE):
        await accepted.wait()
    connection.written = b""
    try:
        yield stream, connection
    finally:
        over.set()


async def test_the_system_keeps_little_that_is_not_on_its_way() -> None:
    """What waits in the gateway is replaced by what is newer."""
    with socket.socket() as line:
        async with served(line):
            assert line.getsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT) == UNSENT_BYTES


@pytest.mark.parametrize(
    ("first", "frame", "at_once"),
    [(b"", PONG, BURST), (BEGIN_OF_TEXT, EMPTY_FRAGMENT, BURST), (b"", EMPTY_TEXT, 0)],
    ids=["pongs", "empty fragments", "messages"],
)
async def test_of_what_one_read_brings_no_more_is_taken_apart_than_a_piece_and_what_is_allowed(
    first: bytes, frame: bytes, at_once: int
) -> None:
    async with served() as (stream, connection):
        stream.data_received(first + 40_000 * frame)
        assert stream.counted <= PIECE / len(frame) + 1
        for _ in range(100):  # turns of the loop
            await asyncio.sleep(0)
        assert stream.counted <= at_once + PIECE / len(frame) + 1
        assert not connection.reading


async def test_who_reads_again_is_answered_its_latest_ping() -> None:
    async with served() as (stream, connection):
        stream.pause_writing()
        for payload in b"abc":
            stream.data_received(b"\x89\x81" + MASK + bytes([payload]))
        assert connection.written == b""
        stream.resume_writing()
        assert connection.written == b"\x8a\x01c"


async def test_a_ping_among_others_is_answered_and_messages_in_pieces_are_read(gateway: Gateway) -> None:
    session = await gateway.session()
    async with raw_stream(gateway, session) as connection:
        text = b'{"type": "ping", "time": 7}'
        pieces = [b"\x01" + bytes([0x80 | 1]) + MASK + text[:1]]
        pieces += [b"\x00" + bytes([0x80 | 1]) + MASK + text[at : at + 1] for at in range(1, len(text) - 1)]
        pieces += [b"\x80" + bytes([0x80 | 1]) + MASK + text[-1:]]
        for piece in pieces:
            connection.send(piece + b"\x89\x81" + MASK + b"p")
        async with asyncio.timeout(PATIENCE):
            received = b""
            while b'{"type":"pong","time":7.0}' not in received or received.count(b"\x8a\x01p") < len(pieces):
                received += await asyncio.get_running_loop().sock_recv(connection, 4096)


@pytest.mark.parametrize(
    ("frames", "code"),
    [
        (b"\x83\x80" + MASK, 1002),
        (b"\x8b\x80" + MASK, 1002),
        (b"\xf1\x80" + MASK, 1002),
        (b"\x81\x00", 1002),
        (b"\x80\x80" + MASK, 1002),
        (b"\x01\x80" + MASK + b"\x81\x80" + MASK, 1002),
        (b"\x09\x80" + MASK, 1002),
        (b"\x89\xfe\x00\x7e" + MASK + bytes(126), 1002),
        (b"\x81\xff" + (2**62).to_bytes(8, "big") + MASK, 1009),
        (b"\x81\xff" + (2**63).to_bytes(8, "big") + MASK, 1009),
        (b"\x81\x82" + MASK + b"\xff\xfe", 1007),
        (b"\x88\x81" + MASK + b"\x03", 1002),
        (b"\x88\x82" + MASK + b"\x00\x01", 1002),
    ],
    ids=["unknown data", "unknown control", "reserved bits", "no mask", "nothing to continue", "text in a text",
         "fragment of a ping", "long ping", "2^62 bytes", "2^63 bytes", "not UTF-8", "half a code", "code 1"],
)  # fmt: skip
async def test_what_is_no_websocket_frame_ends_that_stream_by_its_code_and_no_other(
    gateway: Gateway, frames: bytes, code: int
) -> None:
    session, loop = await gateway.session(), asyncio.get_running_loop()
    async with raw_stream(gateway, session) as connection, gateway.viewer(session) as other:
        await loop.sock_sendall(connection, frames)
        received = b""
        async with asyncio.timeout(PATIENCE):
            while part := await loop.sock_recv(connection, 65536):
                received += part
        assert b"\x88" in received
        assert code.to_bytes(2, "big") in received[received.rindex(b"\x88") :]
        await other.final()
