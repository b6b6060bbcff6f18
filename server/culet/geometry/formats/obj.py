"""Wavefront OBJ: its positions and faces.

Of what else OBJ has, lines, points and free-form surfaces are no polygons; they are left out and said, or, where
nothing else is there, they are the reason of a refusal.
"""

from __future__ import annotations

from collections import Counter

from culet.errors import MeshError
from culet.geometry.formats.found import Found, MeshLimits, counted, fan, part_of
from culet.geometry.formats.text import ascii_text, integer, numbered_lines, point, shown

_FREE_FORM = {b"curv", b"curv2", b"surf", b"bzp", b"bsp", b"cdc", b"cdp"}
"""Statements that make a curve or a surface of control points."""

_WITHOUT_SHAPE = set(
    b"vt vn vp g s o mg usemtl mtllib usemap maplib bevel lod res c_interp d_interp shadow_obj trace_obj ctech stech "
    b"cstype deg bmat step parm trim hole scrv sp con end".split()
)
"""Statements that neither add nor move a polygon."""


def read(data: bytes, limits: MeshLimits) -> Found:
    """One part with all faces; a polygon is cut into a fan of triangles.

    An index counts from 1, or, if negative, back from the vertex before the face. MeshError names the line.
    """
    positions: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    other: Counter[str] = Counter()
    unknown: tuple[int, bytes] | None = None
    highest, highest_line = 0, 0
    for line, words in numbered_lines(ascii_text(data)):
        keyword = words[0]
        if keyword == b"v":
            if len(words) < 4:
                raise MeshError(f"line {line}: expected v x y z, got {shown(b' '.join(words))}")
            positions.append(point(words[1:4], line))
            limits.check_vertices(len(positions))
        elif keyword in {b"f", b"fo"}:
            if len(words) < 4:
                raise MeshError(f"line {line}: expected a face of 3 corners or more, got {shown(b' '.join(words))}")
            limits.check_triangles(len(triangles) + len(words) - 3)
            corners = [_corner(word, len(positions), line) for word in words[1:]]
            if max(corners) >= max(highest, len(positions)):
                highest, highest_line = max(corners), line
            triangles += fan(corners)
        elif keyword in {b"l", b"p"}:
            other["line" if keyword == b"l" else "point"] += 1
        elif keyword in _FREE_FORM:
            other["free-form curve or surface"] += 1
        elif keyword in {b"call", b"csh"}:
            raise MeshError(f"line {line}: {shown(keyword)} asks for another file; expected all of the mesh in one")
        elif keyword not in _WITHOUT_SHAPE:
            other["unknown statement"] += 1
            unknown = unknown or (line, keyword)
    if triangles and highest >= len(positions):
        raise MeshError(f"line {highest_line}: a face names vertex {highest + 1} of {len(positions)}")
    left_out = ", ".join(counted(number, kind, _PLURAL[kind]) for kind, number in sorted(other.items()))
    if unknown is not None:
        left_out += f" (the first in line {unknown[0]}, {shown(unknown[1])})"
    if not triangles:
        raise MeshError(
            f"expected polygons (f), got {counted(len(positions), 'vertex', 'vertices')} without any"
            + (f", and {left_out}" if left_out else "")
        )
    return Found((part_of(positions, triangles),), (f"Left out: {left_out}.",) if left_out else ())


_PLURAL = {
    "line": "lines",
    "point": "points",
    "free-form curve or surface": "free-form curves or surfaces",
    "unknown statement": "unknown statements",
}


def _corner(word: bytes, positions: int, line: int) -> int:
    """Of `position/texture/normal`, the position counted from 0."""
    index = integer(word.partition(b"/")[0], line, "a vertex index")
    if index == 0:
        raise MeshError(f"line {line}: vertex index {shown(word)} is out of range: OBJ counts from 1")
    if index < -positions:
        raise MeshError(f"line {line}: vertex index {shown(word)} is out of range, {positions} vertices so far")
    return index - 1 if index > 0 else positions + index
