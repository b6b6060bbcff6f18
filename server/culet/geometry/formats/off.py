"""OFF (Geomview): polygons, with or without colours and normals."""

from __future__ import annotations

import re

from culet.errors import MeshError
from culet.geometry.formats.found import Found, MeshLimits, counted, fan, part_of
from culet.geometry.formats.text import ascii_text, integer, numbered_lines, point, shown

_HEADER = re.compile(rb"(?:ST)?C?N?(?P<space>4?n?)OFF")
"""Texture coordinates, colours and normals follow each vertex's position, which they leave alone."""


def read(data: bytes, limits: MeshLimits) -> Found:
    """One part with all faces, a polygon cut into a fan of triangles; each vertex and face has a line of its own.

    The word OFF may be missing, as the format says. MeshError names the line.
    """
    lines = numbered_lines(ascii_text(data))
    line, words = next(lines, (1, [b""]))
    header = _HEADER.fullmatch(words[0])
    if header is not None:
        if header["space"]:
            raise MeshError(f"line {line}: {shown(words[0])} has vertices in another space than 3 dimensions")
        if words[1:2] == [b"BINARY"]:
            raise MeshError(f"line {line}: binary OFF is not read; expected text")
        if len(words) == 1:
            line, words = next(lines, (line, []))
        else:
            words = words[1:]
    elif not words[0].isdigit():
        raise MeshError(f"line {line}: expected OFF, got {shown(b' '.join(words))}")
    counts = words[:2]
    if len(counts) < 2 or not all(word.isdigit() and len(word) < 18 for word in counts):
        raise MeshError(
            f"line {line}: expected the numbers of vertices and faces after OFF, got {shown(b' '.join(words))}"
        )
    vertices, faces = map(int, counts)
    limits.check_triangles(faces)
    limits.check_vertices(vertices)
    positions: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    small = 0
    for line, words in lines:
        if len(positions) < vertices:
            if len(words) < 3:
                raise MeshError(f"line {line}: expected x y z, got {shown(b' '.join(words))}")
            positions.append(point(words, line))
            continue
        if faces == 0:
            break
        faces -= 1
        size = integer(words[0], line, "a face's number of corners")
        if not 1 <= size < len(words):
            raise MeshError(
                f"line {line}: expected a number of corners, 1 or more, and that many vertices, "
                f"got {shown(b' '.join(words))}"
            )
        limits.check_triangles(len(triangles) + size - 2)
        corners = [integer(word, line, "a vertex") for word in words[1 : 1 + size]]
        if min(corners) < 0 or max(corners) >= vertices:
            worst = min(corners) if min(corners) < 0 else max(corners)
            raise MeshError(f"line {line}: a face names vertex {worst} of {vertices}, counted from 0")
        small += size < 3
        triangles += fan(corners)
    if len(positions) < vertices or faces:
        raise MeshError(
            f"expected {vertices} vertices and {counts[1].decode()} faces, a line each; the file ends in line {line} "
            f"with {len(positions)} and {int(counts[1]) - faces}"
        )
    said = (f"Left out: {counted(small, 'face', 'faces')} of 1 or 2 corners.",) if small else ()
    return Found((part_of(positions, triangles),), said)
