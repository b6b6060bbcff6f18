"""A transport that lets a client read the answer to a request whose body the client still sends."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from culet.gateway.connections.connection import LINGER_SECONDS


class LingeringTransport(asyncio.Transport):
    """A transport that closes only its own direction while the client sends a body that nobody waits for any more.

    What comes for a closed socket is answered by a reset, and with that the client loses the answer too.
    """

    def __init__(self, transport: asyncio.Transport, is_sending: Callable[[], bool]) -> None:
        super().__init__()
        self._transport = transport
        self._is_sending = is_sending
        self._lingering = False
        self._paused = self._held = False
        self.written = 0

    def close(self) -> None:
        if self._lingering or self._transport.is_closing() or not self._is_sending():
            self._transport.close()
            return
        self._lingering = True
        self._held = False
        self.resume_reading()
        self._transport.write_eof()
        asyncio.get_running_loop().call_later(LINGER_SECONDS, self._transport.abort)

    def is_closing(self) -> bool:
        return self._lingering or self._transport.is_closing()

    def abort(self) -> None:
        self._transport.abort()

    def write(self, data: bytes | bytearray | memoryview[Any]) -> None:
        if not self._lingering:
            self.written += len(data)
            self._transport.write(data)

    def write_eof(self) -> None:
        self._transport.write_eof()

    def can_write_eof(self) -> bool:
        return self._transport.can_write_eof()

    def pause_reading(self) -> None:
        self._paused = True
        self._transport.pause_reading()

    def resume_reading(self) -> None:
        self._paused = False
        if not self._held:
            self._transport.resume_reading()

    def hold(self, held: bool) -> None:
        """Read nothing for now, whoever wants to."""
        self._held = held
        if held:
            self._transport.pause_reading()
        elif not self._paused:
            self._transport.resume_reading()

    def is_reading(self) -> bool:
        return self._transport.is_reading()

    def get_write_buffer_size(self) -> int:
        return self._transport.get_write_buffer_size()

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        self._transport.set_write_buffer_limits(high, low)

    def get_extra_info(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 - as the transport's
        return self._transport.get_extra_info(name, default)

    def set_protocol(self, protocol: asyncio.BaseProtocol) -> None:
        self._transport.set_protocol(protocol)

    def get_protocol(self) -> asyncio.BaseProtocol:
        return self._transport.get_protocol()
