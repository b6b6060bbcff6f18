"""A shape as a file of triangles, for other programs."""

from __future__ import annotations

from culet.geometry.shape import Shape

ENDINGS = ("obj", "ply", "stl")


def mesh_file(shape: Shape, ending: str) -> bytes:
    """Its vertices and triangles: .obj to the last bit of double precision, .ply and .stl in single precision."""
    if ending == "obj":  # by trimesh 17 decimals, which of small coordinates are not all digits
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in shape.vertices.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (shape.triangles + 1).tolist()]
        return "\n".join([*lines, ""]).encode()
    import trimesh

    data = trimesh.Trimesh(shape.vertices, shape.triangles, process=False).export(file_type=ending)
    if not isinstance(data, bytes):
        raise AssertionError(f"expected .{ending} as bytes, got {type(data)}")
    return data
