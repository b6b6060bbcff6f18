"""The folder where PoCL keeps its machine code. It must be there and have room: PoCL compiles nothing without it.

PoCL itself does not say so. Without the folder its builds fail without a reason, and where there is hardly any room
LLVM ends the whole process ("IO failure on output stream"), so programs are made in a process of their own then.
"""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import tempfile
from pathlib import Path

log = logging.getLogger(__name__)

NEEDED_BYTES = 4 << 20
"""For one program. Measured: with 1.5 MB of room the general program was made, with 0.8 MB it was not."""
PLENTY_BYTES = 64 << 20
"""With so much room a program is made without another thought."""


def folder() -> Path:
    """As PoCL's `pocl_cache_init_topdir` finds it."""
    if own := os.environ.get("POCL_CACHE_DIR"):
        return Path(own)
    if cache := os.environ.get("XDG_CACHE_HOME"):
        return Path(cache, "pocl", "kcache")
    return Path(os.environ.get("HOME", "/tmp"), ".cache", "pocl", "kcache")  # noqa: S108 - PoCL's choice


def restore() -> bool:
    """Make the folder if it is gone; whether that was done."""
    if folder().is_dir():
        return False
    with contextlib.suppress(OSError):
        folder().mkdir(parents=True, exist_ok=True)
        log.warning("the folder of compiled programs was missing, and was made: %s", folder())
    return folder().is_dir()


def has_plenty_of_room() -> bool:
    """Whether a compiler surely finds room for what it writes. The folder is made if it is missing."""
    restore()
    try:
        found = os.statvfs(folder())
    except OSError:
        return False
    return found.f_bavail * found.f_frsize >= PLENTY_BYTES


def complaint() -> str | None:
    """Why PoCL cannot write there, and what to do; None if it can. The folder is made if it is missing."""
    restore()
    try:
        with tempfile.TemporaryFile(dir=folder()) as trial:
            os.posix_fallocate(trial.fileno(), 0, NEEDED_BYTES)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            return (
                f"no space left in {folder()}, where PoCL keeps the programs that it compiles; make room there, or "
                f"name another folder by POCL_CACHE_DIR"
            )
        return f"PoCL cannot write to its cache {folder()} ({error.strerror}); name another folder by POCL_CACHE_DIR"
    return None
