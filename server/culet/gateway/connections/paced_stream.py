"""A WebSocket that takes in no more than is asked for, whatever comes: uvicorn's, with the two gaps of it closed.

uvicorn stops reading while a message waits for the application, but has by then taken what one read brings, up to 256
KiB: 40 000 frames, which hold the loop for more than half a second. And frames that no message comes of, pings and
empty fragments, it takes as fast as they come, and answers pings whether or not the answers are read, which fills the
memory.
"""

from __future__ import annotations

import asyncio
import socket
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame

from culet.gateway.limits.bucket import Bucket

PIECE = 4096
"""Bytes that are taken apart in one turn of the loop: up to 680 frames, 10 ms."""
FRAMES_PER_SECOND = 100.0
"""Of pings, pongs and fragments. A browser sends a pong every 20 s, and a control message in one frame."""
UNSENT_BYTES = 16384
"""That the system keeps for a connection besides what is on its way: 0.5 s at 30 kB/s. Unlimited it keeps megabytes."""


class PacedStream(WebSocketsSansIOProtocol):
    """What has come is taken apart piece by piece, and not while a message waits or allowance is lacking."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - as uvicorn's
        super().__init__(*arguments, **options)
        self._come = bytearray()
        self._next: asyncio.Handle | None = None
        self._frames = Bucket(FRAMES_PER_SECOND)
        self._owed: list[bytes] = []

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Have what the line does not take wait here, where a later state or frame replaces it."""
        super().connection_made(transport)
        connection = transport.get_extra_info("socket")
        if connection is not None:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT_BYTES)

    def data_received(self, data: bytes) -> None:
        """Bytes of frames."""
        self._come += data
        if self._next is None and not self.read_paused:
            self._take_apart()

    def _take_apart(self) -> None:
        self._next = None
        if self.transport.is_closing():
            return
        piece = bytes(self._come[:PIECE])
        del self._come[:PIECE]
        if piece:
            super().data_received(piece)
        if not self.read_paused:
            self._go_on()

    def _go_on(self) -> None:
        """With what has come, as soon as there is allowance, or else with reading."""
        wait = self._frames.overdrawn_for(self.loop.time())
        if self._next is not None or self.transport.is_closing():
            return
        if self._come or wait > 0:
            self.transport.pause_reading()
            self._next = self.loop.call_later(wait, self._take_apart)
        else:
            self.transport.resume_reading()

    async def receive(self) -> Any:  # noqa: ANN401 - as uvicorn's
        """The next event for the application; with the last of them it asks for more."""
        message = await self.queue.get()
        if self.read_paused and self.queue.empty():
            self.read_paused = False
            self._go_on()
        return message

    def handle_ping(self) -> None:
        """Answer; while the other end does not read, keep the latest answer only (RFC 6455 section 5.5.3)."""
        self._frames.spend(1, self.loop.time())
        if self.writable.is_set():
            super().handle_ping()
        else:
            self._owed = self.conn.data_to_send()

    def resume_writing(self) -> None:
        """The other end reads again."""
        super().resume_writing()
        owed, self._owed = self._owed, []
        if owed and not self.transport.is_closing():
            self.transport.write(b"".join(owed))

    def handle_pong(self, event: Frame) -> None:
        """It lives."""
        self._frames.spend(1, self.loop.time())
        super().handle_pong(event)

    def handle_cont(self, event: Frame) -> None:
        """A further fragment of a message."""
        self._frames.spend(1, self.loop.time())
        super().handle_cont(event)
