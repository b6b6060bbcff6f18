"""Binary glTF written by hand: what trimesh's exporter never writes."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

COMPONENTS = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}


def container(document: Mapping[str, Any], binary: bytes = b"") -> bytes:
    """A GLB of a document and its binary buffer."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class Document:
    """A glTF document with one scene, built piece by piece."""

    def __init__(self) -> None:
        self.binary = b""
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
        }

    def view(self, data: bytes, **more: object) -> int:
        """A buffer view of these bytes."""
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **more})
        self.binary += data + bytes(-len(data) % 4)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values: NDArray[Any], *, stride: int | None = None, **more: object) -> int:
        """An accessor of an array (N,) or (N, 3), its rows `stride` bytes apart."""
        rows = [row.tobytes() for row in values]
        gap = b"\xff" * ((stride or len(rows[0])) - len(rows[0]))
        view = self.view(gap.join(rows), **({"byteStride": stride} if stride else {}))
        return self.describe(values, bufferView=view, **more)

    def describe(self, values: NDArray[Any], **more: object) -> int:
        """An accessor's description; without a buffer view its items are zeros."""
        self.json["accessors"].append(
            {
                "componentType": COMPONENTS[values.dtype.name],
                "type": "SCALAR" if values.ndim == 1 else "VEC3",
                "count": len(values),
                **more,
            }
        )
        return len(self.json["accessors"]) - 1

    def mesh(self, positions: int, indices: int | None = None, **more: object) -> int:
        """A mesh of one primitive."""
        primitive: dict[str, Any] = {"attributes": {"POSITION": positions}}
        if indices is not None:
            primitive["indices"] = indices
        self.json["meshes"].append({"primitives": [{**primitive, **more}]})
        return len(self.json["meshes"]) - 1

    def show(self, mesh: int, **more: object) -> None:
        """A node of the scene that shows a mesh."""
        self.json["nodes"].append({"mesh": mesh, **more})
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def data(self) -> bytes:
        """The file."""
        return container({**self.json, "buffers": [{"byteLength": len(self.binary)}]}, self.binary)
