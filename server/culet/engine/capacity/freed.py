"""What was freed, and is kept by the C library for whoever asks next."""

from __future__ import annotations

import ctypes


def give_back_freed() -> None:
    """Give back to the system what is free in each heap of the process (malloc_trim(3) of glibc; elsewhere nothing
    happens). By itself glibc gives back only what is free at a heap's end, and keeps most of what compilers took: some
    100 MiB. From any thread; some ms, in which other threads that ask for memory may wait."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(ctypes.c_size_t(0))
