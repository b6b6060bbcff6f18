"""The process's heap: what is freed of it goes back to the system."""

from __future__ import annotations

import contextlib
import ctypes

M_MMAP_THRESHOLD = -3
M_ARENA_MAX = -8
"""As in glibc's malloc.h."""
LARGE = 2**18
"""Bytes from which on a block is the system's own, which it gets back at once: a live picture's sums and its pixels are
larger, hardly anything else is. A fresh one for the pixels of 640x360 takes 0.35 ms to be cleared."""
HEAPS = 2
"""From which all threads take small blocks. By itself glibc makes eight of them for each processor, one for nearly each
thread, and what one thread has freed no other one is given."""


def keep_little() -> None:
    """Have large blocks given back to the system when they are freed, and small ones taken from few heaps; nothing
    where the C library is not glibc. To be called before threads are started.

    Else glibc takes the size that a block must have for that to be the largest that was ever freed, up to 32 MiB
    (mallopt(3)), and what is smaller leaves holes in heaps that something younger keeps.
    """
    with contextlib.suppress(AttributeError):
        library = ctypes.CDLL(None)
        library.mallopt(M_MMAP_THRESHOLD, LARGE)
        library.mallopt(M_ARENA_MAX, HEAPS)
