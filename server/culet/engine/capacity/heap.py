"""The process's heap: what is freed of it goes back to the system."""

from __future__ import annotations

import contextlib
import ctypes

M_MMAP_THRESHOLD = -3
"""As in glibc's malloc.h."""
LARGE = 2**18
"""Bytes from which on a block is the system's own, which it gets back at once: a live picture's sums and its pixels are
larger, hardly anything else is. A fresh one for the pixels of 640x360 takes 0.35 ms to be cleared."""


def return_large_blocks() -> None:
    """Have large blocks given back to the system when they are freed; nothing where the C library is not glibc.

    Else glibc takes the size that a block must have for that to be the largest that was ever freed, up to 32 MiB
    (mallopt(3)), and what is smaller leaves holes in heaps that something younger keeps.
    """
    with contextlib.suppress(AttributeError):
        ctypes.CDLL(None).mallopt(M_MMAP_THRESHOLD, LARGE)
