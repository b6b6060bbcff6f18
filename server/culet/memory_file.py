"""Files that lie in memory and have no name: nothing stays on a disk, whoever dies, and no disk can be full.

Systems without them take files of the temporary folder that have lost their name.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path


def memory_file(name: str) -> int:
    """A new descriptor of an empty file, to be closed by whoever asked; `name` is for those who look into /proc."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create(name, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())


@contextlib.contextmanager
def path_in_memory(data: bytes = b"", *, ending: str) -> Iterator[Path]:
    """A path of a file with these bytes, for libraries that take nothing but paths; gone afterwards."""
    if hasattr(os, "memfd_create"):
        descriptor = memory_file(f"culet.{ending}")
        try:
            with os.fdopen(descriptor, "wb", closefd=False) as file:
                file.write(data)
            yield Path("/proc/self/fd", str(descriptor))
        finally:
            os.close(descriptor)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"file.{ending}")
        path.write_bytes(data)
        yield path
