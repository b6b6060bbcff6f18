"""OFF (Geomview): polygons cut into fans of triangles, colours and comments left out."""

from __future__ import annotations

import re
from itertools import pairwise

from culet.errors import MeshError, TooLargeError

_HEADER = re.compile(rb"\s*(?:ST)?C?N?OFF\b")


def triangles_only(data: bytes, max_triangles: int) -> bytes:
    """The same mesh with three corners a face.

    trimesh 5.2 fails on faces of unlike numbers of corners, and stops without a word where a file ends early.
    TooLargeError if there are more than `max_triangles`.
    """
    bare = re.sub(rb"#[^\n]*", b"", data.replace(b"\r", b"\n"))
    header = _HEADER.match(bare)
    if header is None:
        raise MeshError(f"expected OFF, got {bare[:20].decode('ascii', 'replace')!r}")
    lines = [words for line in bare[header.end() :].split(b"\n") if (words := line.split())]
    try:
        vertices, faces = (int(word) for word in lines[0][:2])
    except (IndexError, ValueError):
        raise MeshError("expected the numbers of vertices and faces after OFF") from None
    if faces > max_triangles:
        raise TooLargeError(f"expected at most {max_triangles} triangles, got {faces} faces")
    if vertices < 0 or faces < 0 or len(lines) < 1 + vertices + faces:
        raise MeshError(f"expected {vertices} vertices and {faces} faces, a line each; got {len(lines) - 1} lines")
    triangles: list[bytes] = []
    for number, words in enumerate(lines[1 + vertices : 1 + vertices + faces]):
        size = int(words[0]) if words[0].isdigit() else -1
        if not 3 <= size < len(words):
            raise MeshError(f"face {number}: expected a number of corners, 3 or more, and that many vertices")
        corners = words[1 : 1 + size]
        triangles += (b"3 " + b" ".join((corners[0], a, b)) for a, b in pairwise(corners[1:]))
        if len(triangles) > max_triangles:
            raise TooLargeError(f"expected at most {max_triangles} triangles, got more")
    points = [b" ".join(words[:3]) for words in lines[1 : 1 + vertices]]
    return b"\n".join([b"OFF", b"%d %d 0" % (vertices, len(triangles)), *points, *triangles, b""])
