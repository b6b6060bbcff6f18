"""Bytes of a mesh file to triangles.

Each format has a reader of its own, because a file of a stranger must be read truly or be refused by the true cause and
line. trimesh 5.2, which writes the files of the tests, takes the normalised integers of a GLB for lengths and leaves
out its sparse items, hides a node that has a camera, takes OBJ's index 0 for 1 and counts its negative ones from the
file's end, reads a binary PLY list as if every row were as long as the first, and names no line.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError, MeshError, TooLargeError
from culet.geometry.formats import glb, obj, off, ply, stl
from culet.geometry.formats.found import Found, MeshLimits

_READERS = {"obj": obj.read, "off": off.read, "stl": stl.read, "ply": ply.read, "glb": glb.read}
FORMATS = tuple(_READERS)


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles as a file gave them: finite, every index in range, nothing else promised."""

    vertices: NDArray[np.float64]
    """(V, 3)."""
    triangles: NDArray[np.int64]
    """(T, 3)."""
    objects: int
    """Meshes that the file's scene shows."""
    findings: tuple[str, ...] = ()
    """What was left out of the file, or taken otherwise than the file says."""
    doubt: str | None = None
    """What may be the cause if the triangles make no stone."""


def read_triangles(data: bytes, file_type: str, *, max_triangles: int, max_bytes: int) -> Soup:
    """Every triangle that the file shows, in its scene's coordinates.

    MeshError if it cannot be read, has no triangles, or has coordinates that are not finite; TooLargeError, from the
    headers where they say so, if there are more than `max_bytes` or `max_triangles`.
    """
    kind = file_type.lower().lstrip(".")
    if kind not in FORMATS:
        raise MeshError(f"expected a mesh of type {', '.join(FORMATS)}, got {file_type[:20]!r}")
    if len(data) > max_bytes:
        raise TooLargeError(f"expected at most {max_bytes} bytes, got {len(data)}")
    if not data.strip():
        raise MeshError("the file is empty")
    limits = MeshLimits(max_triangles)
    try:
        return _joined(_READERS[kind](data, limits), limits)
    except InputError as error:
        raise type(error)(f".{kind}: {error}") from error


def _joined(found: Found, limits: MeshLimits) -> Soup:
    parts = [part for part in found.parts if len(part.triangles)]
    if not parts:
        left_out = f" ({' '.join(found.findings)})" if found.findings else ""
        raise MeshError(f"the mesh is empty: no triangles{left_out}")
    limits.check_triangles(sum(len(part.triangles) for part in parts))
    vertices, triangles, first = [], [], 0
    for part in parts:
        if part.triangles.min() < 0 or part.triangles.max() >= len(part.vertices):
            worst = part.triangles.min() if part.triangles.min() < 0 else part.triangles.max()
            raise MeshError(f"a face names vertex {worst} of {len(part.vertices)}, counted from 0")
        vertices.append(part.vertices)
        triangles.append(part.triangles + first)
        first += len(part.vertices)
    soup = Soup(np.concatenate(vertices), np.concatenate(triangles), len(parts), found.findings, found.doubt)
    used = soup.vertices[np.unique(soup.triangles)]
    bad = int((~np.isfinite(used)).any(axis=1).sum())
    if bad:
        raise MeshError(f"{bad} of {len(used)} vertices have coordinates that are not finite (NaN or infinity)")
    return soup
