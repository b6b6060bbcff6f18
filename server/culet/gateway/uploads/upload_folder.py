"""Uploads as files, so that a gateway which is started after one that died still has them."""

from __future__ import annotations

import contextlib
import logging
import os
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

log = logging.getLogger(__name__)

_NAME = re.compile(r"([0-9a-f]{32})\.([a-z]+)\.([a-z]+)")
_PART = "half-of-an-upload-"
"""Begins the name of a file that is being written."""


class StoredUpload(NamedTuple):
    """A file `id.kind.file_type`."""

    id: str
    kind: str
    file_type: str
    data: bytes


class UploadFolder:
    """The files of one gateway after another. Where one cannot be written, that is logged, and nothing else lost."""

    def __init__(self, folder: Path) -> None:
        """The folder is made if it is missing."""
        self._folder = folder
        with contextlib.suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def write(self, name: str, kind: str, file_type: str, data: bytes | bytearray) -> None:
        """Keep an upload; its file is there completely or not at all."""
        path = self._folder / f"{name}.{kind}.{file_type}"
        if path.exists():
            return
        part = None
        try:
            with tempfile.NamedTemporaryFile(dir=self._folder, prefix=_PART, delete=False) as file:
                part = Path(file.name)
                file.write(data)
            part.replace(path)
        except OSError as error:
            log.warning("an upload would be lost with this process: cannot write %s (%s)", path, error.strerror)
            if part:
                with contextlib.suppress(OSError):  # left over halves go when the next gateway reads
                    part.unlink()

    def remove(self, name: str) -> None:
        """Forget an upload."""
        for path in self._folder.glob(f"{name}.*"):
            path.unlink(missing_ok=True)

    def read(self) -> Iterator[StoredUpload]:
        """All uploads that are there, the latest last. Halves of them are removed; what else is there is let be."""
        with contextlib.suppress(OSError):
            for entry in sorted(os.scandir(self._folder), key=lambda entry: entry.stat().st_mtime):
                if found := _NAME.fullmatch(entry.name):
                    name, kind, file_type = found.groups()
                    yield StoredUpload(name, kind, file_type, Path(entry).read_bytes())
                elif entry.name.startswith(_PART):
                    Path(entry).unlink(missing_ok=True)
