"""One process at a time makes a program; the others find it in the driver's cache.

PoCL 3.1 writes each file of its cache beside its place and renames it, so nobody reads half a file. But a process that
has compiled what another process finished meanwhile removes the other's file before the renaming (`pocl_write_file` in
pocl_file_util.c), and a third process, which has just seen the file, fails to read it. Besides, one of two has compiled
in vain.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import logging
import os
import time
from collections.abc import Iterator
from io import FileIO
from pathlib import Path

log = logging.getLogger(__name__)

LONGEST_WAIT = 60.0
"""s; the slowest program takes 3 of a core. Who holds the lock for so long hangs, and is not waited for."""
BETWEEN_LOOKS = 0.02
"""s"""


MADE = b"made"
"""What the file of a program holds that is in the cache."""


def lacks(cache: Path, program: str) -> bool:
    """Whether another process could put a program into a cache, which does not have it yet, as far as is known.

    Somebody may have taken files out of the cache since the program was made, or it is another driver's: then it is
    compiled anew, in the process that asks for it.
    """
    file = _file(cache, program)
    with contextlib.suppress(OSError):
        if file.stat().st_size > 0:
            return False
    if os.environ.get("POCL_KERNEL_CACHE") == "0":  # PoCL's switch: each process has a cache of its own
        return False
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
    return os.access(file.parent, os.W_OK)


@contextlib.contextmanager
def alone(cache: Path, program: str) -> Iterator[None]:
    """While nobody else on this machine makes a program of that text, options included, for that cache; it counts as
    made after that, unless by an error.

    Where the cache cannot be written there is nothing to be kept apart. The lock ends with the process that holds it.
    """
    name = _file(cache, program)
    try:
        name.parent.mkdir(parents=True, exist_ok=True)
        file = name.open("ab", buffering=0)
    except OSError:
        yield
        return
    with file:
        _lock(file)
        yield
        if not os.fstat(file.fileno()).st_size:
            with contextlib.suppress(OSError):  # without room it does not count as made
                file.write(MADE)


def _file(cache: Path, program: str) -> Path:
    return cache / "making" / hashlib.sha256(program.encode()).hexdigest()[:32]


def _lock(file: FileIO) -> None:
    began = time.monotonic()
    while True:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() - began > LONGEST_WAIT:
                log.warning("another process has been making a program for %g s; not waiting for it", LONGEST_WAIT)
                return
            time.sleep(BETWEEN_LOOKS)
        except OSError:  # a file system without locks
            return
        else:
            return
