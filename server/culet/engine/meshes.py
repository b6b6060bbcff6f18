"""Uploaded meshes: read in a process of their own, kept as stones, the least recently used forgotten first."""

from __future__ import annotations

import asyncio
import pickle
import re
import sys
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from typing import Any

from culet.engine.limits import Limits
from culet.errors import BusyError, InputError, MeshError, TooLargeError
from culet.geometry.stone import Stone

WAITING = 8
"""Meshes that may wait to be read: each holds its bytes in memory."""


class MeshStore(Mapping[str, Stone]):
    """Stones by the id of their mesh."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._stones: OrderedDict[str, Stone] = OrderedDict()
        self._turn = asyncio.Lock()
        self._waiting = 0

    def __getitem__(self, mesh: str) -> Stone:
        stone = self._stones[mesh]
        self._stones.move_to_end(mesh)
        return stone

    def __iter__(self) -> Iterator[str]:
        return iter(self._stones)

    def __len__(self) -> int:
        return len(self._stones)

    async def put(self, mesh: str, file_type: str, data: bytes) -> dict[str, Any]:
        """Read a mesh and keep it; what was found in it, or MeshError, TooLargeError, BusyError."""
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,64}", mesh):
            raise InputError(f"mesh: expected 1 to 64 letters, digits, - or _ as its id, got {mesh!r}", "mesh")
        if len(data) > self._limits.mesh_bytes:
            raise TooLargeError(f"expected a mesh of at most {self._limits.mesh_bytes} bytes, got {len(data)}")
        if self._waiting >= WAITING:
            raise BusyError(f"{WAITING} meshes are waiting to be read")
        self._waiting += 1
        try:
            async with self._turn:
                stone = await read_stone(data, file_type, self._limits)
        finally:
            self._waiting -= 1
        self._stones[mesh] = stone
        self._stones.move_to_end(mesh)
        while len(self._stones) > self._limits.meshes:
            self._stones.popitem(last=False)
        return described(mesh, stone)


async def read_stone(data: bytes, file_type: str, limits: Limits) -> Stone:
    """The stone in a mesh file, read by a process that can be ended, so that no frame waits for it."""
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-m",
        "culet.engine.mesh_reader",
        file_type,
        str(limits.mesh_triangles),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
    )
    try:
        async with asyncio.timeout(limits.mesh_seconds):
            answer, complaint = await process.communicate(data)
    except TimeoutError:
        raise MeshError(f"the mesh could not be read in {limits.mesh_seconds:g} s") from None
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    if process.returncode != 0:
        last = complaint.decode(errors="replace").strip().rpartition("\n")[2]
        raise MeshError(f"the mesh ended the process that read it: {last or f'exit code {process.returncode}'}")
    result = pickle.loads(answer)  # noqa: S301 - written by our own process, which read data and ran none
    if isinstance(result, Stone):
        return result
    raise MeshError(*result)


def described(mesh: str, stone: Stone) -> dict[str, Any]:
    """What an uploader is told."""
    return {
        "mesh": mesh,
        "vertices": len(stone.vertices),
        "triangles": len(stone.triangles),
        "facets": len(stone.planes),
        "convex": bool(stone.convex),
        "volume": float(stone.mass.volume),
        "findings": list(stone.findings),
    }
