"""Uploaded meshes and skies: read in a process of their own and kept, the least recently used forgotten first, but none
that a session shows."""

from __future__ import annotations

import asyncio
import hashlib
import re
from collections import OrderedDict
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.memory import Memory
from culet.engine.library.upload_answer import TooLittleMemoryError
from culet.engine.library.upload_process import Buffer, ReadingRoom, read_upload
from culet.errors import BusyError, InputError, MeshError, TooLargeError
from culet.geometry.shape import Shape
from culet.optics.sky_files.picture import SkyPicture
from culet_protocol.engine import Described, DescribedMesh, DescribedSky

WAITING = 8
"""Uploads of a kind that may wait to be read: each holds its bytes in memory."""
LEAST_TO_READ = 2**26
"""Bytes that must be free for a file to be read at all."""
SHARE_TO_READ = 0.5
"""Of the memory that is free, at first, for one process that reads: another kind may be read at the same time."""
STONE_COPIES = 4
"""Bytes that a mesh takes over those of its arrays: its tree and its hull, and the device's copies of them."""


class Read(Protocol):
    """What was read of a file."""

    @property
    def findings(self) -> tuple[str, ...]:
        """What was found in the file, repaired or left out, a sentence each."""


T = TypeVar("T", bound=Read)


@dataclass(frozen=True)
class StoredKind(Generic[T]):
    """What is uploaded."""

    name: str
    """As upload_reader knows it."""
    plural: str
    content: type[T]
    error: type[InputError]
    """For a file that cannot be read at all."""
    describe: Callable[[T], Described]
    """What an uploader is told."""
    size: Callable[[T], int]
    """Bytes that it takes in memory."""


@dataclass(frozen=True)
class _Kept(Generic[T]):
    content: T
    digest: bytes
    """Of the file that it was read from."""
    described: dict[str, Any]
    """What its uploader was told."""


class UploadStore(Mapping[str, T]):
    """What was read of the uploads of one kind, by their id."""

    def __init__(
        self,
        kind: StoredKind[T],
        limits: Limits,
        memory: Memory | None = None,
        *,
        in_use: Callable[[], Collection[str]] = frozenset,
        forgotten: Callable[[T], object] = lambda _: None,
    ) -> None:
        """`in_use` says which ids sessions show: those are kept. `forgotten` is told what is not kept any more."""
        self._kind = kind
        self._limits = limits
        self._memory = memory or Memory(2**62)
        self._in_use = in_use
        self._forgotten = forgotten
        self._kept: OrderedDict[str, _Kept[T]] = OrderedDict()
        self._needed = LEAST_TO_READ
        """What the last file took for which that was too little: the next one may be like it."""
        self._turn = asyncio.Lock()
        self._waiting = 0
        self._memory.count(kind.plural, lambda: sum(kind.size(kept.content) for kept in self._kept.values()))
        self._memory.give_back(self._forget)

    def __getitem__(self, name: str) -> T:
        found = self._kept[name]
        self._kept.move_to_end(name)
        return found.content

    def __iter__(self) -> Iterator[str]:
        return iter(self._kept)

    def __len__(self) -> int:
        return len(self._kept)

    def contents(self) -> list[T]:
        """All that is kept, without being used by that."""
        return [kept.content for kept in self._kept.values()]

    async def put(self, name: str, file_type: str, data: Buffer) -> dict[str, Any]:
        """Read a file and keep what it holds under a name; what was found in it, or InputError, BusyError."""
        kind = self._kind.name
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,64}", name):
            raise InputError(f"{kind}: expected 1 to 64 letters, digits, - or _ as its id, got {name!r}", kind)
        if len(data) > self._limits.max_upload_bytes:
            raise TooLargeError(f"expected a {kind} of at most {self._limits.max_upload_bytes} bytes, got {len(data)}")
        if self._waiting >= WAITING:
            raise BusyError(f"{WAITING} uploads ({kind}) are waiting to be read")
        self._waiting += 1
        try:
            digest = await asyncio.to_thread(_digest, file_type, data)
            async with self._turn:
                if not self._knows(name, digest):
                    replaced = self._kept.get(name)
                    self._kept[name] = await self._read(name, digest, file_type, data)
                    if replaced is not None:
                        self._forgotten(replaced.content)
                self._kept.move_to_end(name)
                return self._kept[name].described
        finally:
            self._waiting -= 1

    def _knows(self, name: str, digest: bytes) -> bool:
        """Whether that very file was read before: sessions are not to hold one copy of it, and the store another."""
        kept = self._kept.get(name)
        return kept is not None and kept.digest == digest

    async def _read(self, name: str, digest: bytes, file_type: str, data: Buffer) -> _Kept[T]:
        """In a process that can be ended, so that no frame waits for it; its memory is reserved meanwhile.

        At first with what is free. A file for which that is too little is worth what nobody uses.
        """
        kind, limits = self._kind, self._limits
        while self._unused() >= limits.max_uploads and self._forget_one():
            pass
        free = self._memory.make_room(self._needed)
        room = self._room(max(self._needed, int(free * SHARE_TO_READ)))
        while True:
            try:
                kept = await self._read_within(room, digest, file_type, data)
                break
            except TooLittleMemoryError as error:
                needed = error.needed or 2 * room.memory
                self._needed = error.needed or self._needed
                self._memory.make_room(needed)
                more = self._room(min(needed, self._memory.free))
                if more.memory < min(needed, limits.max_read_bytes):
                    raise BusyError(
                        f"reading the {kind.name} needs {needed / 2**20:.0f} MiB of memory, "
                        f"{more.memory / 2**20:.0f} MiB are free; try again later"
                    ) from None
                room = more
        self._needed = min(self._needed, max(LEAST_TO_READ, 2 * kind.size(kept.content)))
        return kept

    def _room(self, size: int) -> ReadingRoom:
        """So much, or what a file may take at most, or at least."""
        most = int(self._limits.max_read_bytes)
        memory = max(LEAST_TO_READ, min(most, size))
        return ReadingRoom(memory, full=memory == most)

    async def _read_within(self, room: ReadingRoom, digest: bytes, file_type: str, data: Buffer) -> _Kept[T]:
        kind = self._kind
        with self._memory.reserved("reading", room.memory, f"reading a {kind.name}"):
            content = await read_upload(kind.name, kind.error, file_type, data, self._limits, room)
            assert isinstance(content, kind.content)  # noqa: S101 - by its kind
            described = await asyncio.to_thread(kind.describe, content)
        return _Kept(content, digest, described.model_dump(mode="json"))

    def _unused(self) -> int:
        """Uploads that no session shows: what sessions show is bounded by sessions and memory."""
        return len(self._kept.keys() - self._in_use())

    def _forget(self, size: int) -> None:
        """Up to so many bytes, the least recently used first."""
        while size > 0 and (forgotten := self._forget_one()):
            size -= forgotten

    def _forget_one(self) -> int:
        """Bytes given back; 0 if sessions show all there is."""
        used = self._in_use()
        for name, kept in self._kept.items():
            if name not in used:
                del self._kept[name]
                self._forgotten(kept.content)
                return max(1, self._kind.size(kept.content))
        return 0


def _digest(file_type: str, data: Buffer) -> bytes:
    digest = hashlib.sha256(file_type.encode() + b"\0")
    digest.update(data)  # which lets other threads run
    return digest.digest()


def described_mesh(shape: Shape) -> DescribedMesh:
    """A mesh in figures, and what was found in it."""
    return DescribedMesh(
        vertices=len(shape.vertices),
        triangles=len(shape.triangles),
        facets=len(shape.planes),
        convex=bool(shape.convex),
        volume=float(shape.mass.volume),
        findings=shape.findings,
    )


def described_sky(picture: SkyPicture) -> DescribedSky:
    """A sky in figures, and what was found in it."""
    height, width, _ = picture.pixels.shape
    return DescribedSky(
        width=width, height=height, largest_radiance=float(picture.pixels.max()), findings=picture.findings
    )


def mesh_size(shape: Shape) -> int:
    """Bytes of a stone and of what is made of it."""
    arrays = (shape.vertices, shape.triangles, shape.facet_of_triangle, shape.planes)
    return STONE_COPIES * sum(array.nbytes for array in arrays)


def sky_size(picture: SkyPicture) -> int:
    """Bytes of a sky's pixels; the device's copies are its own."""
    return int(picture.pixels.nbytes)


MESH = StoredKind("mesh", "meshes", Shape, MeshError, described_mesh, mesh_size)
SKY = StoredKind("sky", "skies", SkyPicture, InputError, described_sky, sky_size)
