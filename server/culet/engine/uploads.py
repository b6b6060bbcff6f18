"""Uploaded meshes and skies: read in a process of their own and kept, the least recently used forgotten first."""

from __future__ import annotations

import asyncio
import pickle
import re
import sys
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from culet.engine.limits import Limits
from culet.errors import BusyError, InputError, MeshError, TooLargeError
from culet.geometry.stone import Stone
from culet.rendering.panoramas import SkyPicture
from culet_protocol.engine import Described, DescribedMesh, DescribedSky

WAITING = 8
"""Uploads of a kind that may wait to be read: each holds its bytes in memory."""


class Read(Protocol):
    """What was read of a file."""

    @property
    def findings(self) -> tuple[str, ...]:
        """What was found in the file, repaired or left out, a sentence each."""


T = TypeVar("T", bound=Read)


@dataclass(frozen=True)
class Kind(Generic[T]):
    """What is uploaded."""

    name: str
    """As upload_reader knows it."""
    error: type[InputError]
    """For a file that cannot be read at all."""
    describe: Callable[[T], Described]
    """What an uploader is told."""


class UploadStore(Mapping[str, T]):
    """What was read of the uploads of one kind, by their id."""

    def __init__(self, kind: Kind[T], limits: Limits) -> None:
        self._kind = kind
        self._limits = limits
        self._kept: OrderedDict[str, _Read[T]] = OrderedDict()
        self._turn = asyncio.Lock()
        self._waiting = 0

    def __getitem__(self, name: str) -> T:
        found = self._kept[name]
        self._kept.move_to_end(name)
        return found.content

    def __iter__(self) -> Iterator[str]:
        return iter(self._kept)

    def __len__(self) -> int:
        return len(self._kept)

    async def put(self, name: str, file_type: str, data: bytes) -> dict[str, Any]:
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
            async with self._turn:
                read = await self._read(data, file_type)
        finally:
            self._waiting -= 1
        self._kept[name] = read
        self._kept.move_to_end(name)
        while len(self._kept) > self._limits.max_uploads or self._over_memory():
            self._kept.popitem(last=False)
        return self._kind.describe(read.content).model_dump(mode="json")

    def _over_memory(self) -> bool:
        return len(self._kept) > 1 and sum(read.size for read in self._kept.values()) > self._limits.max_kept_bytes

    async def _read(self, data: bytes, file_type: str) -> _Read[T]:
        """What the file holds, read by a process that can be ended, so that no frame waits for it."""
        kind, limits = self._kind, self._limits
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "culet.engine.upload_reader", kind.name, file_type, str(limits.max_mesh_triangles),
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE,
        )  # fmt: skip
        try:
            async with asyncio.timeout(limits.read_seconds):
                answer, complaint = await process.communicate(data)
        except TimeoutError:
            raise kind.error(f"the {kind.name} could not be read in {limits.read_seconds:g} s") from None
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode != 0:
            last = complaint.decode(errors="replace").strip().rpartition("\n")[2]
            raise kind.error(
                f"the {kind.name} ended the process that read it: {last or f'exit code {process.returncode}'}"
            )
        content = pickle.loads(answer)  # noqa: S301 - written by our own process, which read data and ran none
        if isinstance(content, InputError):
            raise content
        return _Read(content, len(answer))


@dataclass(frozen=True)
class _Read(Generic[T]):
    content: T
    size: int
    """Bytes, as pickled: what it takes in memory, nearly."""


def described_mesh(stone: Stone) -> DescribedMesh:
    """A mesh in figures, and what was found in it."""
    return DescribedMesh(
        vertices=len(stone.vertices),
        triangles=len(stone.triangles),
        facets=len(stone.planes),
        convex=bool(stone.convex),
        volume=float(stone.mass.volume),
        findings=stone.findings,
    )


def described_sky(picture: SkyPicture) -> DescribedSky:
    """A sky in figures, and what was found in it."""
    height, width, _ = picture.pixels.shape
    return DescribedSky(
        width=width, height=height, largest_radiance=float(picture.pixels.max()), findings=picture.findings
    )


MESH = Kind("mesh", MeshError, described_mesh)
SKY = Kind("sky", InputError, described_sky)
