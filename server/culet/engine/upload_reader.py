"""`python -m culet.engine.upload_reader KIND TYPE MAX_TRIANGLES`: reads a file from stdin, in a process of its own.

What it holds, or the error that says what is wrong with it, goes pickled to stdout.
"""

from __future__ import annotations

import pickle
import resource
import sys

from culet.errors import InputError

MEMORY = 4 * 2**30
"""Bytes of address space: some ten times what the largest mesh allowed needs, so that a hostile one fails here."""


def read(kind: str, data: bytes, file_type: str, max_triangles: int) -> object:
    """The Stone of a mesh, the SkyPicture of a sky; InputError."""
    if kind == "mesh":
        from culet.geometry.mesh import stone_from_mesh

        return stone_from_mesh(data, file_type, max_triangles=max_triangles)
    from culet.rendering.panoramas import read_sky

    return read_sky(data, file_type)


def main() -> None:
    """Read, answer, end."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    kind, file_type, max_triangles = sys.argv[1:]
    try:
        answer = read(kind, sys.stdin.buffer.read(), file_type, int(max_triangles))
    except InputError as error:
        answer = error
    pickle.dump(answer, sys.stdout.buffer, protocol=pickle.HIGHEST_PROTOCOL)


if __name__ == "__main__":
    main()
