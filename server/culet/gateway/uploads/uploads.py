"""Uploads: named by their content, described by the engine, and kept to be given to it again.

The engine forgets what was not used for long, and a new one knows nothing. It refuses a scene then by the field that
names the upload; it is given that, and asked once more.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections import OrderedDict
from collections.abc import Callable, Iterator, Set
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Self, get_args

from culet.errors import BusyError, InputError
from culet.gateway.engine.link import EngineLink
from culet.gateway.uploads.form import UploadedFile
from culet.gateway.uploads.upload_folder import UploadFolder
from culet_protocol.engine import MeshType, PutMesh, PutSky, SkyType
from culet_protocol.messages import Message

GIVEN_AT_ONCE = 4
"""Uploads that a new engine is given again: it reads one of a kind at a time, and lets few wait."""


@dataclass(frozen=True)
class UploadKind:
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


MESH = UploadKind("mesh", get_args(MeshType))
SKY = UploadKind("sky", get_args(SkyType))
KIND_OF_FIELD = {"mesh": MESH, "image": SKY}
"""By the last part of the field that names an upload."""


@dataclass(frozen=True)
class _Upload:
    kind: UploadKind
    file_type: str
    data: bytes | bytearray
    id: str

    @classmethod
    def of(cls, kind: UploadKind, file: UploadedFile) -> Self:
        """The upload of a file, named by what is in it and what it is taken for; InputError for another ending."""
        file_type = kind.file_type(file.name)
        return cls(kind, file_type, file.data, id_of(file_type, file.digest))

    async def give(self, link: EngineLink) -> dict[str, Any]:
        """What the engine says about it."""
        message = {"file_type": self.file_type, self.kind.name: self.id}
        put = PutMesh.model_validate(message) if self.kind is MESH else PutSky.model_validate(message)
        described, _ = await link.request(put, self.data, patient=True)
        return described


class Uploads:
    """The bytes of accepted uploads, the latest used last; bounded in sum. What sessions use is not forgotten."""

    def __init__(self, link: EngineLink, max_bytes: int, folder: Path | None = None) -> None:
        """Those that a gateway before this one kept in the folder are there at once."""
        self.used: Callable[[], Set[str]] = frozenset
        """Ids that sessions name, maybe among other words."""
        self._link = link
        self._max_bytes = max_bytes
        self._kept: OrderedDict[str, _Upload] = OrderedDict()
        self._giving: dict[str, asyncio.Task[None]] = {}
        self._turns = asyncio.Semaphore(GIVEN_AT_ONCE)
        self._folder = UploadFolder(folder) if folder else None
        for stored in self._folder.read() if self._folder else ():
            kind = {MESH.name: MESH, SKY.name: SKY}.get(stored.kind)
            if kind is not None and stored.id == id_of(stored.file_type, hashlib.sha256(stored.data).digest()):
                self._kept[stored.id] = _Upload(kind, stored.file_type, stored.data, stored.id)

    @property
    def kept_bytes(self) -> int:
        """Bytes of all kept uploads."""
        return sum(len(upload.data) for upload in self._kept.values())

    async def put(self, kind: UploadKind, file: UploadedFile) -> tuple[str, dict[str, Any]]:
        """Have the engine read a file; its id and what the engine says about it. The same file has the same id.

        BusyError if there is no room for it besides what sessions use.
        """
        upload = _Upload.of(kind, file)
        used = self.used() - {upload.id}
        in_use = sum(len(kept.data) for name, kept in self._kept.items() if name in used)
        if in_use + len(file.data) > self._max_bytes:
            raise BusyError(
                f"sessions use uploads of {in_use} bytes; with these {len(file.data)} they would be over the limit of "
                f"{self._max_bytes}; close a session, or try again later"
            )
        described = await upload.give(self._link)
        self._keep(upload)
        if self._folder:
            await asyncio.to_thread(self._folder.write, upload.id, kind.name, upload.file_type, upload.data)
            if upload.id not in self._kept:  # others needed its room before its file was there
                self._folder.remove(upload.id)
        return upload.id, described

    async def request(
        self, message: Message, *about: dict[str, Any] | None, patient: bool = False, for_asker: bool = False
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        """As `EngineLink.request`; the engine is given what it lacks of the uploads that `message` or `about` name."""
        for _ in KIND_OF_FIELD:  # a scene can lack one of each kind
            try:
                return await self._link.request(message, patient=patient, for_asker=for_asker)
            except InputError as error:
                lacking = self._lacking(error.field or "", words(message.model_dump()), words(about))
                if not lacking:
                    raise
            for upload in lacking:
                await self._give_again(upload)
                self._keep(upload)
        return await self._link.request(message, patient=patient, for_asker=for_asker)

    async def _give_again(self, upload: _Upload) -> None:
        """Once for all who ask for it at the same time."""
        giving = self._giving.get(upload.id)
        if giving is None:
            giving = self._giving[upload.id] = asyncio.create_task(self._give_in_turn(upload))
            giving.add_done_callback(lambda _: self._giving.pop(upload.id, None))
        await asyncio.shield(giving)

    async def _give_in_turn(self, upload: _Upload) -> None:
        async with self._turns:
            await upload.give(self._link)

    def _lacking(self, field: str, named: set[str], about: set[str]) -> list[_Upload]:
        """Those of the kind that the field names; the message's own last, in case the engine keeps only few."""
        kind = KIND_OF_FIELD.get(field.rpartition(".")[2])
        found = [upload for name, upload in self._kept.items() if upload.kind is kind and name in named | about]
        return sorted(found, key=lambda upload: upload.id in named)

    def _keep(self, upload: _Upload) -> None:
        self._kept[upload.id] = upload
        self._kept.move_to_end(upload.id)
        needed = self.used() | {upload.id}
        for name in [name for name in self._kept if name not in needed]:
            if self.kept_bytes <= self._max_bytes:
                break
            del self._kept[name]
            if self._folder:
                self._folder.remove(name)


def id_of(file_type: str, digest: bytes) -> str:
    """By what a scene names an upload: what it is taken for, and the SHA-256 of its bytes."""
    return hashlib.sha256(file_type.encode() + b"\0" + digest).hexdigest()[:32]


def words(document: object) -> set[str]:
    """All texts in parsed JSON; the ids of uploads are among them."""
    return set(_words(document))


def _words(document: object) -> Iterator[str]:
    if isinstance(document, str):
        yield document
    elif isinstance(document, dict | list | tuple):
        for part in document.values() if isinstance(document, dict) else document:
            yield from _words(part)
