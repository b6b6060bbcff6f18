"""A shape as a file of triangles, for other programs."""

from __future__ import annotations

from typing import Any

from culet.geometry.shape import Shape

ENDINGS = ("obj", "ply", "stl")
DIGITS = 17
"""Of a number in text: as many as tell any two doubles apart."""


def mesh_file(shape: Shape, ending: str) -> bytes:
    """Its vertices and triangles as they are: .obj in double precision, .ply and .stl in single precision."""
    import trimesh

    solid = trimesh.Trimesh(shape.vertices, shape.triangles, process=False)
    options: dict[str, Any] = {"digits": DIGITS, "include_normals": False, "header": None} if ending == "obj" else {}
    data = solid.export(file_type=ending, **options)
    return data.encode() if isinstance(data, str) else bytes(data)
