"""Bytes of a mesh file to triangles, through trimesh, which never sees a path."""

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.resolvers import Resolver

from culet.errors import InputError, MeshError, TooLargeError
from culet.geometry.formats import glb, obj, off, ply
from culet.geometry.formats.ply import ascii_only

# What trimesh logs about the files of strangers is no news of this program; what matters becomes an error or a finding.
logging.getLogger("trimesh").addHandler(logging.NullHandler())

FORMATS = ("obj", "off", "stl", "ply", "glb")


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles as a file gave them: finite, every index in range, nothing else promised."""

    vertices: NDArray[np.float64]
    """(V, 3)."""
    triangles: NDArray[np.int64]
    """(T, 3)."""
    objects: int
    """Meshes that the file's scene shows."""


class _NoOtherFiles(Resolver):
    """A mesh that names another file does not get it."""

    def __init__(self) -> None:
        """Nothing to remember."""

    def get(self, key: str) -> NoReturn:
        """Refuse."""
        raise MeshError(f"the mesh asks for another file, {str(key)[:60]!r}; expected all of it in one")

    def write(self, name: str, data: object) -> NoReturn:
        """Refuse."""
        raise MeshError("a mesh writes nothing")

    def namespaced(self, namespace: str) -> _NoOtherFiles:
        """Nothing there either."""
        return self

    def keys(self) -> Iterator[str]:
        """No names."""
        return iter(())


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
    try:
        parts = list(_parts(_prepared(data, kind, max_triangles), kind))
    except InputError as error:
        raise type(error)(f".{kind}: {error}") from error
    except Exception as error:  # trimesh raises whatever its parsers met: anything but a mesh
        raise MeshError(f".{kind}: not a readable mesh ({type(error).__name__}: {str(error)[:120]})") from error
    return _joined(parts, kind, max_triangles)


def _prepared(data: bytes, kind: str, max_triangles: int) -> bytes:
    """What trimesh may read: checked, counted where the format tells, and without what it would misread."""
    if kind == "obj":
        return obj.positions_and_faces(data, max_triangles)
    if kind == "off":
        return off.triangles_only(data, max_triangles)
    if kind == "ply":
        return ply.plain_polygons(data, max_triangles)
    if kind == "glb":
        glb.check(data, max_triangles)
    if kind == "stl":
        binary = len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little")
        text = b"" if binary else data.lower()
        if not binary and b"solid" not in text:
            raise MeshError("expected text from 'solid' to 'endsolid', or binary of 84 bytes and 50 for each triangle")
        count = (len(data) - 84) // 50 if binary else text.count(b"endfacet")
        if count > max_triangles:
            raise TooLargeError(f"expected at most {max_triangles} triangles, got {count}")
        return data if binary else ascii_only(data)
    return data


def _parts(data: bytes, kind: str) -> Iterator[tuple[NDArray[np.float64], NDArray[np.int64]]]:
    """Vertices and triangles of each mesh of the scene, moved to where the scene shows it."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        # NumPy stops at the first word that is no number and only warns; what came before it is not the mesh.
        warnings.filterwarnings("error", message=".*could not be read to its end.*")
        options: dict[str, Any] = {"process": False, "skip_materials": True}
        if kind == "obj":
            options["maintain_order"] = True  # keeps vertices that no face uses, to be counted
        scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=_NoOtherFiles(), **options)
        for node in scene.graph.nodes_geometry:
            transform, name = scene.graph[node]
            mesh = scene.geometry[name]
            if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
                continue
            matrix = np.asarray(transform, np.float64)
            vertices = np.asarray(mesh.vertices, np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            triangles = np.asarray(mesh.faces, np.int64)
            mirrored = np.linalg.det(matrix[:3, :3]) < 0
            yield vertices, triangles[:, ::-1] if mirrored else triangles


def _joined(parts: list[tuple[NDArray[np.float64], NDArray[np.int64]]], kind: str, max_triangles: int) -> Soup:
    if not parts:
        raise MeshError(f".{kind}: the mesh is empty: no triangles")
    count = sum(len(triangles) for _, triangles in parts)
    if count > max_triangles:
        raise TooLargeError(f".{kind}: expected at most {max_triangles} triangles, got {count}")
    all_vertices, all_triangles, first = [], [], 0
    for vertices, triangles in parts:
        if triangles.ndim != 2 or triangles.shape[1] != 3 or vertices.ndim != 2 or vertices.shape[1] != 3:
            raise MeshError(f".{kind}: expected triangles in space, got shape {triangles.shape}")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            worst = triangles.min() if triangles.min() < 0 else triangles.max()
            raise MeshError(f".{kind}: a face names vertex {worst} of {len(vertices)}")
        all_vertices.append(vertices)
        all_triangles.append(triangles + first)
        first += len(vertices)
    soup = Soup(np.concatenate(all_vertices), np.concatenate(all_triangles), len(parts))
    used = soup.vertices[np.unique(soup.triangles)]
    bad = int((~np.isfinite(used)).any(axis=1).sum())
    if bad:
        raise MeshError(
            f".{kind}: {bad} of {len(used)} vertices have coordinates that are not finite (NaN or infinity)"
        )
    return soup
