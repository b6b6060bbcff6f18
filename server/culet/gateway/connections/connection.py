"""One connection as its guard knows it: what the connection waits for, since when, and what has come of it."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

LINGER_SECONDS = 5.0
"""After an answer that did not wait for the whole body: for the rest of the body, so that the answer is read."""


class Guarded(Protocol):
    """What a guard needs of the protocol that serves a connection."""

    @property
    def transport(self) -> asyncio.Transport:
        """The connection itself."""

    @property
    def may_read(self) -> bool:
        """Whether the client may send, as far as this side lets it."""

    def tell(self) -> None:
        """Have the connection enter the phase that it is in now."""

    def written(self) -> int:
        """Bytes of answers that the transport was given."""

    def refuse(self, status: int, title: str, detail: str) -> None:
        """Answer by a problem document, unless an answer has begun, and close."""


class Phase(Enum):
    """What a connection is waiting for."""

    HEAD = auto()
    """For a request: nothing has come, or a part of its head."""
    BODY = auto()
    """For the rest of a request's body."""
    LINGER = auto()
    """For the rest of a body whose request is answered already."""
    ANSWER = auto()
    """For the application, or for the client to read the answer."""
    STREAM = auto()
    """For nothing: it is a WebSocket, which looks after itself."""


WAITING = (Phase.HEAD, Phase.BODY, Phase.LINGER)
"""The server waits for the client."""


@dataclass(eq=False)
class GuardedConnection:
    """One connection, as the guard knows it."""

    protocol: Guarded
    address: str | None
    """The client; None for a trusted proxy, whose connections are many clients'."""
    since: float
    """When its phase began."""
    phase: Phase = Phase.HEAD
    looked: float = 0.0
    """When its progress was looked at last."""
    received: int = 0
    """Bytes since then."""
    unread: int = 0
    """Bytes of the answer that waited for the client to take them then."""
    taken: int = 0
    """Bytes that it had taken, of all answers."""
    partial: bool = False
    """Whether something of a head has come."""

    def enter(self, phase: Phase, now: float) -> None:
        """The phase that it is in now."""
        if phase is not self.phase:
            self.phase = phase
            self.since = self.looked = now
            self.received = self.unread = 0
