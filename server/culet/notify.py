"""How a process tells whoever supervises it that it is ready and that it lives: systemd's protocol, sd_notify(3)."""

from __future__ import annotations

import contextlib
import os
import socket
from enum import StrEnum

ADDRESS = "NOTIFY_SOCKET"
"""Environment variable that names the supervisor's datagram socket."""


PATIENCE = "WATCHDOG_USEC"
"""Before the microseconds of silence after which the process counts as hung."""


class ServiceNotice(StrEnum):
    """What is said."""

    READY = "READY=1"
    """It does what it is for."""
    ALIVE = "WATCHDOG=1"
    """It still works; one that does not say so for long is taken for hung."""
    STOPPING = "STOPPING=1"
    """It is about to end, as it was told to."""


def notify_patience(seconds: float) -> None:
    """Ask the supervisor to take this process for hung only after so long, from now on."""
    _send(f"{PATIENCE}={round(1e6 * seconds)}\n{ServiceNotice.ALIVE}")


def notify(notice: ServiceNotice) -> None:
    """Tell the supervisor, if there is one; never waits, never fails."""
    _send(notice)


def _send(text: str) -> None:
    address = os.environ.get(ADDRESS)
    if not address:
        return
    with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        sender.setblocking(False)
        sender.sendto(text.encode(), "\0" + address[1:] if address.startswith("@") else address)
