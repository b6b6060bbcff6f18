"""What the process gives back to the system, seen from a process of its own: how a heap goes on depends on its past."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

BLOCKS = 64
HOLES = """
import ctypes, os, sys

from culet.engine.capacity.heap import return_large_blocks

if sys.argv[1] == "returning":
    return_large_blocks()
c = ctypes.CDLL(None)
c.malloc.restype, c.malloc.argtypes, c.free.argtypes = ctypes.c_void_p, [ctypes.c_size_t], [ctypes.c_void_p]


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


def left(how: str) -> float:
    """MiB of large blocks that were freed, each followed by a small one that is kept."""
    run = subprocess.run([sys.executable, "-c", HOLES, how, str(BLOCKS)], capture_output=True, text=True, check=True)
    return float(run.stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="of other C libraries nothing is known")
def test_what_is_freed_between_small_blocks_goes_back_to_the_system() -> None:
    assert left("as it is") > BLOCKS / 2, "or there is nothing to be done about it"
    assert left("returning") < 4
