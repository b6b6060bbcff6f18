"""Uploads: named by their content, described by the engine, kept for an engine that is started later."""

from __future__ import annotations

import hashlib
import logging
from collections import OrderedDict
from collections.abc import Set
from pathlib import PurePosixPath
from typing import Any, get_args

from culet.errors import BusyError, InputError
from culet.gateway.form import UploadedFile
from culet.gateway.link import EngineLink
from culet_protocol.engine import MeshType, PutMesh

log = logging.getLogger(__name__)

FILE_TYPES: tuple[MeshType, ...] = get_args(MeshType)


class Meshes:
    """The bytes of accepted uploads, the latest used last; bounded in sum."""

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._kept: OrderedDict[str, tuple[MeshType, bytes]] = OrderedDict()

    @property
    def kept_bytes(self) -> int:
        """Bytes of all kept uploads."""
        return sum(len(data) for _, data in self._kept.values())

    async def put(self, link: EngineLink, file: UploadedFile) -> tuple[str, dict[str, Any]]:
        """Have the engine read a mesh; its id and what the engine says about it. The same file has the same id."""
        file_type = file_type_of(file.name)
        mesh = hashlib.sha256(file_type.encode() + b"\0" + file.data).hexdigest()[:32]
        described, _ = await link.request(PutMesh(file_type=file_type, mesh=mesh), file.data, patient=True)
        self._kept[mesh] = (file_type, file.data)
        self._kept.move_to_end(mesh)
        while self.kept_bytes > self._max_bytes:
            self._kept.popitem(last=False)
        return mesh, described

    async def restore(self, link: EngineLink, wanted: Set[str] | None) -> None:
        """Give a new engine the kept uploads of these ids, or all."""
        for mesh, (file_type, data) in list(self._kept.items()):
            if wanted is None or mesh in wanted:
                try:
                    await link.request(PutMesh(file_type=file_type, mesh=mesh), data, patient=True)
                except (InputError, BusyError) as error:
                    log.warning("mesh %s was not taken again: %s", mesh, error)


def file_type_of(name: str) -> MeshType:
    """The mesh format that a file name's ending says, or InputError."""
    ending = PurePosixPath(name).suffix.removeprefix(".").lower()
    for file_type in FILE_TYPES:
        if ending == file_type:
            return file_type
    known = ", ".join(f".{known}" for known in FILE_TYPES)
    raise InputError(f"file: expected a name that ends with one of {known}, got {name[:80]!r}", "file")
