"""Binary glTF 2.0: the container, and which of its extensions are read.

What may change where a corner is, or whether it is there, is read, told, or refused by name: the glTF specification,
sections 3.5 (nodes), 3.6 (accessors), 3.7 (meshes, skins, morph targets), and its extensions.
"""

from __future__ import annotations

import json
import struct
from typing import Any

from culet.errors import MeshError, TooLargeError
from culet.geometry.formats.found import Found, MeshLimits
from culet.geometry.formats.gltf_scene import parts_of

MAX_JSON = 8 << 20
"""Bytes: the largest number of nodes allowed takes a quarter of it. Python takes some thirty times as much."""

_COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")

_READ = ("KHR_mesh_quantization", "KHR_node_visibility")

_WITHOUT_SHAPE = (
    *("KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"),
    *("KHR_lights_", "EXT_lights_", "KHR_xmp"),
)
"""How the names of extensions begin that neither add nor move a corner."""


def read(data: bytes, limits: MeshLimits) -> Found:
    """A part for each mesh that the scene shows, where it shows it. MeshError names what cannot be read."""
    try:
        document, binary = _chunks(data)
        _check_extensions(document)
        buffers = document.get("buffers", [])
        if any("uri" in buffer for buffer in buffers):
            raise MeshError("glTF refers to another file or a data URI; expected one binary buffer within the file")
        if buffers and buffers[0]["byteLength"] > len(binary):
            raise MeshError(
                f"glTF announces a buffer of {buffers[0]['byteLength']} bytes, got {len(binary)}: the file is cut off"
            )
        return parts_of(document, binary, limits)
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, RecursionError, OverflowError) as error:
        raise MeshError(f"glTF is malformed: {type(error).__name__} {str(error)[:80]}") from None


def _chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON and the bytes of the binary buffer."""
    if len(data) < 20:
        raise MeshError(f"expected a GLB header of 20 bytes, got {len(data)} bytes")
    magic, version, whole, length, kind = struct.unpack_from("<4sIII4s", data)
    if magic != b"glTF" or kind != b"JSON":
        raise MeshError("expected binary glTF 2.0 with a JSON chunk")
    if version != 2:
        raise MeshError(f"expected binary glTF 2.0, got version {version}")
    if whole > len(data):
        raise MeshError(f"glTF announces {whole} bytes, got {len(data)}: the file is cut off")
    if 20 + length > whole:
        raise MeshError(f"glTF announces a JSON chunk of {length} bytes in a file of {whole}")
    if length > MAX_JSON:
        raise TooLargeError(f"expected a JSON chunk of at most {MAX_JSON} bytes, got {length}")
    document = json.loads(data[20 : 20 + length])
    if not isinstance(document, dict):
        raise MeshError("glTF is malformed: its JSON is no object")
    start = 20 + length
    if start + 8 > whole:
        return document, b""
    size, kind = struct.unpack_from("<I4s", data, start)
    if kind != b"BIN\0":
        return document, b""
    if start + 8 + size > whole:
        raise MeshError(f"glTF announces a binary chunk of {size} bytes, got {whole - start - 8}: the file is cut off")
    return document, data[start + 8 : start + 8 + size]


def _check_extensions(document: dict[str, Any]) -> None:
    required, used = document.get("extensionsRequired", []), document.get("extensionsUsed", [])
    for name in _COMPRESSED:
        if name in required or name in used:
            raise MeshError(f"glTF uses {name}, which is not read; export it without compression")
    for name in required:
        if name not in _READ and not str(name).startswith(_WITHOUT_SHAPE):
            raise MeshError(f"glTF requires {str(name)[:60]!r}, which is not read; export it without this extension")
