"""Wavefront OBJ, reduced to positions and faces."""

from __future__ import annotations

from culet.errors import MeshError, TooLargeError


def positions_and_faces(data: bytes, max_triangles: int) -> bytes:
    """The same mesh with `v` and `f` lines alone, faces counted from 1.

    trimesh 5.2 reads negative indices from the end of the file instead of from the face's own line, takes index 0 for
    1, and splits a mesh by its materials; none of that is left here. A polygon of n corners counts n - 2 triangles;
    TooLargeError if there are more than `max_triangles`.
    """
    positions: list[bytes] = []
    faces: list[bytes] = []
    triangles = highest = 0
    text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\\\n", b" ")
    for number, line in enumerate(text.split(b"\n"), start=1):
        words = line.split(b"#", 1)[0].split()
        if not words:
            continue
        if words[0] == b"v":
            if len(words) < 4:
                raise MeshError(f"line {number}: expected v x y z, got {_shown(line)}")
            positions.append(b"v " + b" ".join(words[1:4]))
        elif words[0] == b"f":
            if len(words) < 4:
                raise MeshError(f"line {number}: expected a face of 3 corners or more, got {_shown(line)}")
            triangles += len(words) - 3
            if triangles > max_triangles:
                raise TooLargeError(f"expected at most {max_triangles} triangles, got more")
            corners = [_corner(word, len(positions), number) for word in words[1:]]
            highest = max(highest, *corners)
            faces.append(b"f " + b" ".join(b"%d" % corner for corner in corners))
    if highest > len(positions):
        raise MeshError(f"a face names vertex {highest} of {len(positions)}")
    return b"\n".join([*positions, *faces, b""])


def _corner(word: bytes, positions: int, line: int) -> int:
    """Of `position/texture/normal`, the position counted from 1."""
    try:
        index = int(word.split(b"/", 1)[0])
    except ValueError:
        raise MeshError(f"line {line}: expected a vertex index, got {_shown(word)}") from None
    if index < 0:
        index += positions + 1
    if index < 1:
        raise MeshError(f"line {line}: vertex index {_shown(word)} is out of range, {positions} vertices so far")
    return index


def _shown(text: bytes) -> str:
    return repr(text[:60].decode("ascii", "replace"))
