"""Binary glTF 2.0: what is refused, and what is too large, before anything is built from it."""

from __future__ import annotations

import json
import struct
from typing import Any

from culet.errors import MeshError, TooLargeError

MAX_NODES = 10_000
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_UNREAD = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")


def check(data: bytes, max_triangles: int) -> None:
    """Read the JSON chunk alone. MeshError names what cannot be read, TooLargeError what is too much."""
    try:
        _check(_document(data), len(data), max_triangles)
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, RecursionError) as error:
        raise MeshError(f"glTF is malformed: {type(error).__name__} {str(error)[:80]}") from None


def _document(data: bytes) -> dict[str, Any]:
    if len(data) < 20:
        raise MeshError(f"expected a GLB header of 20 bytes, got {len(data)} bytes")
    magic, version, _, length, kind = struct.unpack_from("<4sIII4s", data)
    if magic != b"glTF" or version != 2 or kind != b"JSON" or 20 + length > len(data):
        raise MeshError("expected binary glTF 2.0 with a JSON chunk")
    document = json.loads(data[20 : 20 + length])
    if not isinstance(document, dict):
        raise MeshError("glTF is malformed: its JSON is no object")
    return document


def _check(document: dict[str, Any], size: int, max_triangles: int) -> None:
    for name in _UNREAD:
        if name in document.get("extensionsRequired", []) or name in document.get("extensionsUsed", []):
            raise MeshError(f"glTF uses {name}, which is not read; export it without compression")
    if any("uri" in buffer for buffer in document.get("buffers", [])):
        raise MeshError("glTF refers to another file or a data URI; expected one binary buffer within the file")
    accessors = document.get("accessors", [])
    for accessor in accessors:
        if "sparse" in accessor or "bufferView" not in accessor:
            raise MeshError("glTF has a sparse or empty accessor, which is not read")
        if not isinstance(accessor["count"], int) or not 0 <= accessor["count"] <= size:
            raise MeshError(f"glTF accessor claims {accessor['count']} items in a file of {size} bytes")
    triangles = [sum(_triangles(p, accessors) for p in mesh["primitives"]) for mesh in document.get("meshes", [])]
    total = 0
    for index in _nodes(document):
        mesh = document["nodes"][index].get("mesh")
        if mesh is not None:
            total += triangles[mesh]
            if total > max_triangles:
                raise TooLargeError(f"expected at most {max_triangles} triangles, got at least {total}")


def _triangles(primitive: dict[str, Any], accessors: list[dict[str, Any]]) -> int:
    mode = primitive.get("mode", _TRIANGLES)
    if mode == _FAN:
        raise MeshError("glTF has a triangle fan, which is not read; export triangles")
    corners = int(accessors[primitive.get("indices", primitive["attributes"]["POSITION"])]["count"])
    if mode == _TRIANGLES:
        return corners // 3
    return max(corners - 2, 0) if mode == _STRIP else 0


def _nodes(document: dict[str, Any]) -> list[int]:
    """Nodes of the scene that is shown; each has one parent, as the format demands, so that there is no cycle."""
    scenes = document.get("scenes", [])
    if not scenes:
        raise MeshError("glTF has no scene")
    waiting = list(scenes[document.get("scene", 0)].get("nodes", []))
    found: list[int] = []
    seen: set[int] = set()
    while waiting:
        index = waiting.pop()
        if index in seen:
            raise MeshError(f"glTF node {index} has two parents")
        seen.add(index)
        found.append(index)
        if len(found) > MAX_NODES:
            raise TooLargeError(f"expected at most {MAX_NODES} glTF nodes, got more")
        waiting += document["nodes"][index].get("children", [])
    return found
