"""PLY (Turk 1994): the header, and what its vertices and faces make."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError
from culet.geometry.formats.found import Found, MeshLimits, MeshPart, counted
from culet.geometry.formats.ply_rows import Element, Lists, Property, binary_rows, text_rows
from culet.geometry.formats.text import ascii_text, has_mark, shown

_CODES = {
    **dict.fromkeys(("char", "int8"), "b"),
    **dict.fromkeys(("uchar", "uint8"), "B"),
    **dict.fromkeys(("short", "int16"), "h"),
    **dict.fromkeys(("ushort", "uint16"), "H"),
    **dict.fromkeys(("int", "int32"), "i"),
    **dict.fromkeys(("uint", "uint32"), "I"),
    **dict.fromkeys(("float", "float32"), "f"),
    **dict.fromkeys(("double", "float64"), "d"),
}
"""PLY's type names to those of `struct`."""

_MAX_HEADER = 1 << 20
"""Bytes; exporters write a few hundred."""

_END = re.compile(rb"^[ \t]*end_header[ \t]*(\r\n|\n|\r)", re.MULTILINE)
_CORNERS = ("vertex_indices", "vertex_index")
"""The names that exporters give a face's list of vertices."""


@dataclass(frozen=True)
class PlyHeader:
    """What stands before the rows."""

    encoding: str
    """ascii, binary_little_endian or binary_big_endian."""
    elements: tuple[Element, ...]
    size: int
    """Bytes."""
    lines: int


def read(data: bytes, limits: MeshLimits) -> Found:
    """One part with all faces, a polygon cut into a fan of triangles. MeshError names the line of a text file."""
    if has_mark(data):
        data = ascii_text(data)
    header = read_header(data)
    vertex, face = _only(header, "vertex"), _only(header, "face")
    if face is None or face.count == 0:
        strips = next((element for element in header.elements if element.name == "tristrips"), None)
        if strips is not None:
            raise MeshError("PLY holds triangle strips (tristrips), which are not read; export faces")
        raise MeshError("PLY has no faces: points are no solid")
    if vertex is None:
        raise MeshError("PLY has no element vertex")
    limits.check_triangles(face.count)
    limits.check_vertices(vertex.count)
    for axis in "xyz":
        if not any(own.name == axis and own.length is None for own in vertex.properties):
            raise MeshError(f"PLY has no property {axis} of a vertex; expected x, y and z")
    corners = next((own for own in face.properties if own.name in _CORNERS), None)
    if corners is None or corners.length is None or corners.code in "fd":
        raise MeshError(f"PLY has no list of integers {' or '.join(_CORNERS)} of a face; expected the vertices of each")
    if header.encoding == "ascii":
        wanted = {**{("vertex", axis): None for axis in "xyz"}, ("face", corners.name): vertex.count}
        columns = text_rows(ascii_text(data[header.size :]), header.lines + 1, header.elements, wanted)
    else:
        order = "<" if header.encoding == "binary_little_endian" else ">"
        columns = binary_rows(data, header.size, header.elements, order)
    positions = [values for axis in "xyz" if isinstance(values := columns["vertex"].get(axis), np.ndarray)]
    lists = columns["face"][corners.name]
    if not isinstance(lists, Lists) or len(positions) < 3:
        raise MeshError("PLY has vertices with lists of unlike lengths, which are not read")
    triangles = _fans(lists, limits)
    small = int((lists.lengths < 3).sum())
    said = (f"Left out: {counted(small, 'face', 'faces')} of less than 3 corners.",) if small else ()
    return Found((MeshPart(np.column_stack(positions), triangles),), said)


def read_header(data: bytes) -> PlyHeader:
    """MeshError names the line that cannot be understood."""
    end = _END.search(data, 0, _MAX_HEADER)
    text = ascii_text(data[: end.end()]) if end is not None else b""
    lines = [line.split() for line in text.split(b"\n")[:-1]]
    if not lines or lines[0] != [b"ply"]:
        raise MeshError("expected a PLY header, 'ply' to 'end_header'")
    encoding = b""
    elements: list[Element] = []
    for number, words in enumerate(lines[1:-1], start=2):
        match words:
            case [] | [b"comment" | b"obj_info", *_]:
                pass
            case [b"format", encoding, _]:
                pass
            case [b"element", name, count] if count.isdigit() and len(count) < 18:
                elements.append(Element(name.decode(), int(count), ()))
            case [b"property", b"list", length, item, name] if elements:
                own = Property(name.decode(), _code(item, number), _code(length, number))
                elements[-1] = _with(elements[-1], own, number)
            case [b"property", kind, name] if elements and kind != b"list":
                elements[-1] = _with(elements[-1], Property(name.decode(), _code(kind, number)), number)
            case _:
                raise MeshError(f"PLY header, line {number}: {shown(b' '.join(words))} cannot be understood")
    if encoding not in {b"ascii", b"binary_little_endian", b"binary_big_endian"}:
        raise MeshError(f"PLY format {shown(encoding)} is not known")
    return PlyHeader(encoding.decode(), tuple(elements), end.end() if end is not None else 0, len(lines))


def _only(header: PlyHeader, name: str) -> Element | None:
    """The element of that name; MeshError if there are two."""
    own = [element for element in header.elements if element.name == name]
    if len(own) > 1:
        raise MeshError(f"PLY has {len(own)} elements {name}; expected one")
    return own[0] if own else None


def _code(kind: bytes, line: int) -> str:
    try:
        return _CODES[kind.decode()]
    except KeyError:
        raise MeshError(
            f"PLY header, line {line}: type {shown(kind)} is not known; expected one of {', '.join(_CODES)}"
        ) from None


def _with(element: Element, own: Property, line: int) -> Element:
    if any(own.name == other.name for other in element.properties):
        raise MeshError(f"PLY header, line {line}: {element.name} has two properties {own.name!r}")
    return replace(element, properties=(*element.properties, own))


def _fans(lists: Lists, limits: MeshLimits) -> NDArray[np.int64]:
    """(T, 3) the triangles of each polygon, from its first corner."""
    each = np.maximum(lists.lengths - 2, 0)
    limits.check_triangles(int(each.sum()))
    first = np.cumsum(lists.lengths) - lists.lengths
    begin = np.repeat(first, each)
    step = np.arange(int(each.sum())) - np.repeat(np.cumsum(each) - each, each)
    return np.column_stack([lists.items[begin], lists.items[begin + step + 1], lists.items[begin + step + 2]])
