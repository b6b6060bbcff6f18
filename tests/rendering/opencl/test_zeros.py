"""Zeros on the device."""

from __future__ import annotations

import errno
import gc
import os
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from culet.rendering.opencl.device import Device
from culet.rendering.opencl.zeros import zeros

SIZE = 2**28


def resident() -> int:
    """Bytes of memory that this process has, as the system counts them."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not tell what a process has")
def test_of_zeros_only_what_is_written_takes_memory(device: Device) -> None:
    if not device.shares_memory:
        pytest.skip("the device has memory of its own")
    before = resident()
    buffer = zeros(device, SIZE)
    cl.enqueue_fill_buffer(device.queue, buffer, np.array(7, np.uint8), SIZE // 2, 2**20)
    device.queue.finish()
    assert resident() - before < 2**25
    found = np.empty(2**22, np.uint8)
    cl.enqueue_copy(device.queue, found, buffer, src_offset=SIZE // 2 - 2**20)
    assert (np.flatnonzero(found) == np.arange(2**20, 2**21)).all()
    del buffer
    assert resident() - before < 2**25


def test_where_there_is_no_memory_that_is_all_that_is_said(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is left of such a buffer ends without a word: warnings are errors here."""
    if not device.shares_memory:
        pytest.skip("the device has memory of its own")

    def full(*_: object) -> None:
        raise OSError(errno.ENOMEM, "no memory")

    monkeypatch.setattr("culet.rendering.opencl.zeros.mmap.mmap", full)
    with pytest.raises(OSError, match="no memory"):
        zeros(device, 2**20)
    gc.collect()


def test_zeros_are_zeros_where_there_was_something_before(device: Device) -> None:
    for _ in range(3):
        buffer, found = zeros(device, 2**22), np.empty(2**22, np.uint8)
        cl.enqueue_copy(device.queue, found, buffer)
        assert not found.any()
        cl.enqueue_fill_buffer(device.queue, buffer, np.array(7, np.uint8), 0, 2**22)
        del buffer
