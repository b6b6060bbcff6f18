"""The folder of a server's own sockets; those of servers that were killed are cleared away by the next one."""

from __future__ import annotations

import contextlib
import fcntl
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

PARENT = Path("/tmp")  # noqa: S108 - mkdtemp makes a folder of our own in it
"""A socket's path may have 107 bytes (sun_path), so the folder is not made under a long TMPDIR."""
PREFIX = "culet-"
LOCK = "lock"
"""File that a living server has locked: unlike a process id, that cannot be taken over by another process."""


@contextlib.contextmanager
def socket_folder(parent: Path = PARENT) -> Iterator[Path]:
    """A new folder, gone at the end."""
    clear_abandoned(parent)
    with tempfile.TemporaryDirectory(prefix=PREFIX, dir=parent) as name:
        folder = Path(name)
        unlocked = folder / f"{LOCK}.new"  # under its name only once it is locked, or another server might take it
        with unlocked.open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            unlocked.rename(folder / LOCK)
            yield folder


def clear_abandoned(parent: Path) -> None:
    """Remove the folders whose servers have ended without doing so; those of other users stay."""
    for path in parent.glob(f"{PREFIX}*/{LOCK}"):
        with contextlib.suppress(OSError), path.open() as lock:  # BlockingIOError: its server lives
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(path.parent)
