"""STL: triangles, each with corners of its own, as binary rows or as text."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from culet.errors import MeshError
from culet.geometry.formats.found import Found, MeshLimits, MeshPart, part_of
from culet.geometry.formats.text import ascii_text, has_mark, numbered_lines, point, shown

_HEADER, _ROW = 84, 50
"""Bytes: a comment of 80 and the count of triangles; normal, three corners and an attribute."""

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

_TEXT = re.compile(rb"^[ \t]*(?:solid|facet)\b", re.IGNORECASE | re.MULTILINE)


def read(data: bytes, limits: MeshLimits) -> Found:
    """A part for each solid. MeshError names the line, or the bytes that are missing."""
    announced = int.from_bytes(data[80:_HEADER], "little") if len(data) >= _HEADER else None
    whole = announced is not None and len(data) == _HEADER + _ROW * announced
    if not whole and (has_mark(data) or (b"\0" not in data[:1024] and _TEXT.search(data[:4096]))):
        return _text(data, limits)
    if announced is None:
        raise MeshError("expected text from 'solid' to 'endsolid', or binary of 84 bytes and 50 for each triangle")
    wanted = _HEADER + _ROW * announced
    if len(data) < wanted:
        raise MeshError(
            f"expected text that begins with 'solid', or binary; as binary the file is cut off: its header announces "
            f"{announced} triangles in {wanted} bytes, got {len(data)} bytes"
        )
    limits.check_triangles(announced)
    rows = np.frombuffer(data, _TRIANGLE, announced, _HEADER)
    part = MeshPart(
        rows["corners"].reshape(-1, 3).astype(np.float64), np.arange(3 * announced, dtype=np.int64).reshape(-1, 3)
    )
    rest = len(data) - wanted
    return Found((part,), (f"Left out: {rest} bytes after the last triangle.",) if rest else ())


@dataclass
class _Solid:
    positions: list[tuple[float, float, float]] = field(default_factory=list)

    def part(self) -> MeshPart:
        corners = range(0, len(self.positions), 3)
        return part_of(self.positions, [(k, k + 1, k + 2) for k in corners])


def _text(data: bytes, limits: MeshLimits) -> Found:
    solids: list[_Solid] = []
    inside = False  # of a solid, until its endsolid
    corners: int | None = None  # of the facet that is being read
    line = 0
    text = ascii_text(data)
    limits.check_triangles(text.lower().count(b"endfacet"))
    for line, words in numbered_lines(text, comment=b"\n"):
        match [word.lower() for word in words[:2]]:
            case [b"solid", *_] if corners is None:
                solids.append(_Solid())
                inside = True
            case [b"facet", *_] if corners is None:
                if not inside:
                    raise MeshError(f"line {line}: expected solid, got a facet")
                limits.check_triangles(len(solids[-1].positions) // 3 + 1)
                corners = 0
            case [b"vertex", *_] if corners is not None:
                if len(words) < 4:
                    raise MeshError(f"line {line}: expected vertex x y z, got {shown(b' '.join(words))}")
                solids[-1].positions.append(point(words[1:4], line))
                corners += 1
            case [b"endfacet", *_] | [b"end", b"facet"] if corners is not None:
                if corners != 3:
                    raise MeshError(f"line {line}: expected a facet of 3 vertices, got {corners}")
                corners = None
            case [b"endsolid", *_] | [b"end", b"solid"] if corners is None and inside:
                inside = False
            case [b"outer" | b"endloop", *_] | [b"end", b"loop"] if corners is not None:
                pass
            case _:
                expected = (
                    "outer loop, vertex, endloop or endfacet"
                    if corners is not None
                    else "facet or endsolid"
                    if inside
                    else "solid"
                )
                raise MeshError(f"line {line}: expected {expected}, got {shown(b' '.join(words))}")
    if corners is not None:
        raise MeshError(f"the file is cut off: it ends in line {line}, within a facet; expected 'endsolid'")
    parts = tuple(solid.part() for solid in solids if solid.positions)
    if not inside:
        return Found(parts)
    cut_off = f"the file ends in line {line} without 'endsolid'"
    return Found(parts, (f"{cut_off[0].upper()}{cut_off[1:]}: its whole facets were read.",), f"{cut_off}: cut off?")
