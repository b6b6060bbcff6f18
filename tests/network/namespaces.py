"""Network namespaces of this process's threads and children."""

from __future__ import annotations

import ctypes
import os

CLONE_NEWNET = 0x40000000
"""linux/sched.h"""

_libc = ctypes.CDLL(None, use_errno=True)


def leave() -> None:
    """Give the calling thread a network namespace of its own, with nothing in it. OSError if it may not."""
    _check(_libc.unshare(CLONE_NEWNET))


def enter(path: str) -> None:
    """Have the calling thread enter a network namespace by its file. OSError if it may not."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        _check(_libc.setns(descriptor, CLONE_NEWNET))
    finally:
        os.close(descriptor)


def _check(result: int) -> None:
    if result != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
