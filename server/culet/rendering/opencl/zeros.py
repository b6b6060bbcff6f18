"""Zeros on the device, of which only what is touched takes memory."""

from __future__ import annotations

import mmap
from typing import Any

import numpy as np
import pyopencl as cl

from culet.rendering.opencl.device import Device


def zeros(device: Device, size: int) -> Any:  # noqa: ANN401 - pyopencl has no types
    """A buffer of so many bytes, all 0, to be read and written.

    A device that shares this process's memory gets pages of the system's own, which are zero and are there only once
    they are touched (mmap(2), MAP_ANONYMOUS). Neither the C library's nor numpy's zeros would do: a block that was
    freed before is cleared by hand, and numpy asks for pages of 2 MiB.
    """
    if device.shares_memory:
        return _Pages(device, size)
    buffer = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, size)
    cl.enqueue_fill_buffer(device.queue, buffer, np.array(0, np.uint8), 0, size)
    return buffer


class _Pages(cl.Buffer):
    """A buffer in pages that are this process's own, and go with it."""

    def __init__(self, device: Device, size: int) -> None:
        self._queue = device.queue  # first: what fails to be made is ended, too
        pages = np.frombuffer(mmap.mmap(-1, size, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS), np.uint8)
        super().__init__(device.context, cl.mem_flags.READ_WRITE | cl.mem_flags.USE_HOST_PTR, hostbuf=pages)

    def __del__(self) -> None:
        """Of memory of its own the driver knows when the last kernel is done with it, of this it does not."""
        self._queue.finish()
