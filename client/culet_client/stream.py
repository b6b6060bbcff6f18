"""A session's WebSocket: control events out; notices and frames in."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Self
from urllib.parse import urlsplit, urlunsplit

from pydantic import ValidationError
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidURI
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from culet_client.errors import ClientError, SilenceError
from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame, FrameError
from culet_protocol.messages import Ack, Message, notice

LONGEST_MESSAGE = 64 * 2**20
"""Bytes; a PNG of a large frame."""


class ControlStream:
    """One viewer of a session. Every frame taken is acknowledged, which is what lets the next one come."""

    def __init__(self, server: str, session: str, *, timeout_seconds: float = 10) -> None:
        """Connect to a gateway, such as `http://127.0.0.1:8000`; ClientError if that fails."""
        self.url = stream_url(server, session)
        self._open = ExitStack()
        try:
            connection = connect(
                self.url,
                subprotocols=[Subprotocol(SUBPROTOCOL)],
                compression=None,
                max_size=LONGEST_MESSAGE,
                open_timeout=timeout_seconds,
            )
            self._socket: ClientConnection = self._open.enter_context(connection)
        except (OSError, InvalidHandshake, InvalidURI, TimeoutError) as error:
            raise ClientError(f"cannot open {self.url}: {error}") from error

    def send(self, event: Message) -> None:
        """Send a control event, such as `culet_protocol.messages.Orbit(yaw=0.1, pitch=0)`."""
        try:
            self._socket.send(event.model_dump_json())
        except ConnectionClosed as error:
            raise closed(error) from error

    def receive(self, timeout_seconds: float = 10) -> Frame | Message:
        """The next frame or notice; SilenceError, or ClientError when the server closed or does not speak culet."""
        try:
            message = self._socket.recv(timeout_seconds)
            if isinstance(message, str):
                return notice.validate_json(message)
            frame = Frame.unpack(message)
        except TimeoutError as error:
            raise SilenceError(f"nothing from {self.url} in {timeout_seconds:g} s") from error
        except ConnectionClosed as error:
            raise closed(error) from error
        except (ValidationError, FrameError) as error:
            raise ClientError(f"{self.url} sent something that is not understood: {error}") from error
        self.send(Ack(sequence=frame.sequence))
        return frame

    def close(self) -> None:
        """Leave."""
        self._open.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def stream_url(server: str, session: str) -> str:
    """The WebSocket's address at a gateway."""
    parts = urlsplit(server)
    scheme = {"http": "ws", "https": "wss", "ws": "ws", "wss": "wss"}.get(parts.scheme)
    if scheme is None or not parts.netloc:
        raise ClientError(f"expected a server such as http://127.0.0.1:8000, got {server!r}")
    return urlunsplit((scheme, parts.netloc, f"{parts.path.rstrip('/')}/api/sessions/{session}/stream", "", ""))


def closed(error: ConnectionClosed) -> ClientError:
    """Why the server ended the stream."""
    if error.rcvd is None:
        return ClientError("the server went away")
    return ClientError(f"the server closed the stream: {error.rcvd.reason or 'no reason given'} ({error.rcvd.code})")
