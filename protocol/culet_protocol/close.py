"""Why a stream ended: WebSocket close codes (RFC 6455 section 7.4, and the private range from 4000)."""

from __future__ import annotations

from enum import IntEnum


class CloseCode(IntEnum):
    """What the gateway closes a stream with; any other code, 1006 above all, is a lost connection."""

    NORMAL = 1000
    """Asked for by the viewer."""
    GOING_AWAY = 1001
    """The gateway stops."""
    PROTOCOL_ERROR = 1002
    """No subprotocol in common: the page is older or newer than the server."""
    INTERNAL_ERROR = 1011
    """The gateway failed."""
    SERVICE_RESTART = 1012
    """The gateway restarts."""
    FORBIDDEN_ORIGIN = 4403
    """A page of another origin may not watch."""
    UNKNOWN_SESSION = 4404
    """There is no such session, or it ended while it was watched."""
    TOO_SLOW = 4408
    """The viewer does not read what it is sent."""
    BUSY = 4429
    """The session has as many viewers as it may."""


FINAL = frozenset(
    {
        CloseCode.NORMAL,
        CloseCode.PROTOCOL_ERROR,
        CloseCode.FORBIDDEN_ORIGIN,
        CloseCode.UNKNOWN_SESSION,
    }
)
"""After these a client does not try again by itself; after all others it does, with growing pauses."""
