"""`python -m culet.engine.mesh_reader TYPE MAX_TRIANGLES`: a mesh on stdin; a pickled Stone or the defect on stdout."""

from __future__ import annotations

import pickle
import resource
import sys

from culet.errors import MeshError
from culet.geometry.mesh import stone_from_mesh

MEMORY = 4 * 2**30
"""Bytes of address space: some ten times what the largest mesh allowed needs, so that a hostile one fails here."""


def main() -> None:
    """Read, answer, end."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    file_type, max_triangles = sys.argv[1], int(sys.argv[2])
    try:
        answer: object = stone_from_mesh(sys.stdin.buffer.read(), file_type, max_triangles=max_triangles)
    except MeshError as error:
        answer = (str(error), error.field)
    pickle.dump(answer, sys.stdout.buffer)


if __name__ == "__main__":
    main()
