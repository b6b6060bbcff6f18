"""Which culet this is, to the letter: workers of another one would make other pictures."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

import culet
import culet_kernels
from culet.version import __version__

SOURCES = (".py", ".cl")


@functools.cache
def edition() -> str:
    """The version, and a digest of all sources of the server and of its kernels."""
    found = hashlib.sha256()
    for package in (culet, culet_kernels):
        folder = Path(str(package.__file__)).parent
        for file in sorted(file for file in folder.rglob("*") if file.suffix in SOURCES):
            found.update(f"{file.relative_to(folder).as_posix()}\0".encode() + file.read_bytes() + b"\0")
    return f"{__version__} ({found.hexdigest()[:12]})"
