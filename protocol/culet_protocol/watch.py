"""The watch id: who knows it may look at a session, and cannot steer it.

It is the ZeroMQ topic of the session's frames, and stands in their headers. Whoever knows the session's id can derive
it; nobody can go back.
"""

from __future__ import annotations

import hashlib
import hmac

TEXT = b"culet watch"
WATCH_BYTES = 16


def watch_key(session: str) -> bytes:
    """The 16 bytes of a session's watch id: the first of HMAC-SHA-256, the session id's bytes being the key."""
    return hmac.digest(bytes.fromhex(session), TEXT, hashlib.sha256)[:WATCH_BYTES]


def watch_id(session: str) -> str:
    """The watch id of a session, as 32 hexadecimal digits."""
    return watch_key(session).hex()
