"""Ports for servers that cannot say which one they were given."""

from __future__ import annotations

import random
import socket
from contextlib import suppress


def free_port() -> int:
    """That nobody listens on now, below those that the system gives to connections, of which there are always some."""
    for port in random.SystemRandom().sample(range(20_000, 30_000), 100):
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise AssertionError("a hundred ports are taken")
