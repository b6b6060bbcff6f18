"""The file of a stone, a mesh or a cutter's design, made into a shape or refused."""

from __future__ import annotations

from culet.errors import InputError, MeshError
from culet.geometry.designs.reader import DESIGN_TYPES, read_design
from culet.geometry.designs.solid import shape_of_design
from culet.geometry.formats import FORMATS
from culet.geometry.mesh import MAX_TRIANGLES, shape_from_mesh
from culet.geometry.shape import Shape

STONE_TYPES = (*FORMATS, *DESIGN_TYPES)
"""Endings of file names, without the dot."""


def shape_from_file(data: bytes, file_type: str, *, max_triangles: int = MAX_TRIANGLES, name: str = "mesh") -> Shape:
    """The shape in a file of that type, scaled to circumradius 1, with what was found in it.

    MeshError says what is wrong with the file, TooLargeError names a limit.
    """
    kind = file_type.lower().lstrip(".")
    if kind in FORMATS:
        return shape_from_mesh(data, kind, max_triangles=max_triangles, name=name)
    if kind not in DESIGN_TYPES:
        raise MeshError(f"expected a mesh or a design of type {', '.join(STONE_TYPES)}, got {kind[:20]!r}")
    design = read_design(data, kind)
    try:
        return shape_of_design(design, name)
    except InputError as error:
        raise type(error)(f".{kind}: {error}") from error
