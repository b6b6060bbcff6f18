"""Uploads: named by their content, described by the engine, kept for an engine that is started later."""

from __future__ import annotations

import hashlib
import logging
from collections import OrderedDict
from collections.abc import Set
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any, get_args

from culet.errors import BusyError, InputError
from culet.gateway.form import UploadedFile
from culet.gateway.link import EngineLink
from culet_protocol.engine import MeshType, PutMesh, PutSky, SkyType

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Kind:
    """What can be uploaded."""

    name: str
    file_types: tuple[str, ...]
    """Endings of file names, without the dot."""

    def file_type(self, name: str) -> str:
        """The format that a file name's ending says, or InputError."""
        ending = PurePosixPath(name).suffix.removeprefix(".").lower()
        if ending not in self.file_types:
            known = ", ".join(f".{known}" for known in self.file_types)
            raise InputError(f"file: expected a name that ends with one of {known}, got {name[:80]!r}", "file")
        return ending


MESH = Kind("mesh", get_args(MeshType))
SKY = Kind("sky", get_args(SkyType))


@dataclass(frozen=True)
class _Upload:
    kind: Kind
    file_type: str
    data: bytes

    @property
    def id(self) -> str:
        return hashlib.sha256(self.file_type.encode() + b"\0" + self.data).hexdigest()[:32]

    async def give(self, link: EngineLink) -> dict[str, Any]:
        """What the engine says about it."""
        message = {"file_type": self.file_type, self.kind.name: self.id}
        put = PutMesh.model_validate(message) if self.kind is MESH else PutSky.model_validate(message)
        described, _ = await link.request(put, self.data, patient=True)
        return described


class Uploads:
    """The bytes of accepted uploads, the latest used last; bounded in sum."""

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._kept: OrderedDict[str, _Upload] = OrderedDict()

    @property
    def kept_bytes(self) -> int:
        """Bytes of all kept uploads."""
        return sum(len(upload.data) for upload in self._kept.values())

    async def put(self, link: EngineLink, kind: Kind, file: UploadedFile) -> tuple[str, dict[str, Any]]:
        """Have the engine read a file; its id and what the engine says about it. The same file has the same id."""
        upload = _Upload(kind, kind.file_type(file.name), file.data)
        described = await upload.give(link)
        self._kept[upload.id] = upload
        self._kept.move_to_end(upload.id)
        while self.kept_bytes > self._max_bytes:
            self._kept.popitem(last=False)
        return upload.id, described

    async def restore(self, link: EngineLink, wanted: Set[str] | None) -> None:
        """Give a new engine the kept uploads of these ids, or all."""
        for name, upload in list(self._kept.items()):
            if wanted is None or name in wanted:
                try:
                    await upload.give(link)
                except (InputError, BusyError) as error:
                    log.warning("%s %s was not taken again: %s", upload.kind.name, name, error)


def uploads_of(document: dict[str, Any]) -> set[str]:
    """Ids that a scene, or the snapshot of a session, may name."""
    named = [stone.get("mesh") for stone in document.get("stones", ())]
    named.append((document.get("environment") or {}).get("image"))
    return {name for name in named if name}
