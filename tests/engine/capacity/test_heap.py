"""What the process gives back to the system, seen from a process of its own: how a heap goes on depends on its past."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

from culet.engine.capacity import heap

BLOCKS = 64
BEGIN = """
import ctypes, os, re, sys, threading

from culet.engine.capacity.heap import keep_little

if sys.argv[1] == "returning":
    keep_little()
c = ctypes.CDLL(None)
c.malloc.restype, c.malloc.argtypes, c.free.argtypes = ctypes.c_void_p, [ctypes.c_size_t], [ctypes.c_void_p]
"""
HOLES = """
def filled(size):
    block = c.malloc(size)
    ctypes.memset(block, 1, size)
    return block


def resident():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


before = resident()
c.free(filled(16 * 2**20))
between = [(filled(2**20), filled(2**12)) for _ in range(int(sys.argv[2]))]
for large, _ in between:
    c.free(large)
print((resident() - before) / 2**20)
"""


THREADS = 12
HEAPS = """
together, heaps = threading.Barrier(int(sys.argv[2])), set()


def work():
    together.wait()
    heaps.add(c.malloc(1000) >> 26)  # a heap of a thread's own lies within 64 MiB, at a multiple of that
    together.wait()


threads = [threading.Thread(target=work) for _ in range(int(sys.argv[2]))]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(len(heaps))
"""


def left(how: str) -> float:
    """MiB of large blocks that were freed, each followed by a small one that is kept."""
    return told(HOLES, how, BLOCKS)


def told(program: str, how: str, count: int) -> float:
    """What a process of its own prints."""
    run = subprocess.run(
        [sys.executable, "-c", BEGIN + program, how, str(count)], capture_output=True, text=True, check=True
    )
    return float(run.stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="of other C libraries nothing is known")
def test_what_is_freed_between_small_blocks_goes_back_to_the_system() -> None:
    assert left("as it is") > BLOCKS / 2, "or there is nothing to be done about it"
    assert left("returning") < 4


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="of other C libraries nothing is known")
def test_threads_share_few_heaps() -> None:
    assert told(HEAPS, "as it is", THREADS) > 4, "or there is nothing to be done about it"
    assert told(HEAPS, "returning", THREADS) <= heap.HEAPS + 1, "the process's own may lie in two such ranges"
