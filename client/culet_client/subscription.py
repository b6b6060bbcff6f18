"""Frames of one session straight from the engine's ZeroMQ socket, without the gateway."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Self

import zmq

from culet_client.errors import ClientError, SilenceError
from culet_client.key_folder import checked_keys
from culet_protocol.frame import Frame, FrameError

FRAMES_WAITING = 64
"""Frames that wait here when every one is wanted: two seconds at 30 frames/s."""
KEEP_ALIVE = (
    (zmq.TCP_KEEPALIVE, 1),
    (zmq.TCP_KEEPALIVE_IDLE, 5),
    (zmq.TCP_KEEPALIVE_INTVL, 5),
    (zmq.TCP_KEEPALIVE_CNT, 3),
)
"""The kernel notices an engine's machine that vanished after 5 s of silence and three questions 5 s apart, so that it
is reconnected to when it comes back. ZeroMQ's own heartbeats would do that too, but libzmq 4.3.5 ends the process where
one runs out while frames wait at the high-water mark, that is, whenever the taker pauses for long."""


class FrameSubscription:
    """Receives a session's frames by its watch id; subscribing makes the engine render, and send its latest at once.

    With `latest_only` a slow taker skips frames (ZMQ_CONFLATE: one slot, the newest wins) and is never behind.
    """

    def __init__(self, endpoint: str, watch: str, *, latest_only: bool = True, keys: Path | None = None) -> None:
        """ClientError for an id that is none, an address that cannot be connected to, or keys that cannot be read: of
        the folder `keys`, or the one that CULET_KEYS names, for an engine on another machine."""
        if not re.fullmatch(r"[0-9a-f]{32}", watch):
            raise ClientError(f"a watch id has 32 hexadecimal digits, got {watch!r}")
        self.endpoint, self.watch = endpoint, watch
        known = checked_keys(endpoint, keys)
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.SUB)
        self._socket.setsockopt(zmq.LINGER, 0)
        if latest_only:
            self._socket.setsockopt(zmq.CONFLATE, 1)
        else:
            self._socket.setsockopt(zmq.RCVHWM, FRAMES_WAITING)
        for option, value in KEEP_ALIVE:
            self._socket.setsockopt(option, value)
        self._socket.setsockopt(zmq.SUBSCRIBE, bytes.fromhex(watch))
        if known is not None:
            known.apply(self._socket, endpoint)
        try:
            self._socket.connect(endpoint)
        except zmq.ZMQError as error:
            self.close()
            raise ClientError(
                f"cannot connect to {endpoint!r}: {error}; expected such as tcp://127.0.0.1:5556"
            ) from error

    def receive(self, timeout_seconds: float = 10) -> Frame:
        """The next frame (a picture at rest comes again, ever more rarely, but every 8 s at least); SilenceError,
        ClientError for other bytes."""
        if not self._socket.poll(int(timeout_seconds * 1000)):
            raise SilenceError(
                f"no frame of watch id {self.watch} from {self.endpoint} in {timeout_seconds:g} s; "
                f"is the engine there, and does it publish frames at this address?"
            )
        try:
            return Frame.unpack(self._socket.recv())
        except FrameError as error:
            raise ClientError(f"{self.endpoint} sent something else than a frame: {error}") from error

    def close(self) -> None:
        """Stop receiving; nobody else watching, the engine stops rendering."""
        self._context.destroy(linger=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
