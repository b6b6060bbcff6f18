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
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

log = logging.getLogger(__name__)

LONGEST_WAIT = 60.0
"""s; the slowest program takes 3 of a core. Who holds the lock for so long hangs, and is not waited for."""
BETWEEN_LOOKS = 0.02
"""s"""


@contextlib.contextmanager
def alone(cache: Path, program: str) -> Iterator[None]:
    """While nobody else on this machine makes a program of that text, options included, for that cache.

    Where the cache cannot be written there is nothing to be kept apart. The lock ends with the process that holds it.
    """
    folder = cache / "making"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / hashlib.sha256(program.encode()).hexdigest()[:32]).open("wb")
    except OSError:
        yield
        return
    with file:
        _lock(file)
        yield


def _lock(file: IO[bytes]) -> None:
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
