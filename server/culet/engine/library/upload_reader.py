"""`python -m culet.engine.library.upload_reader`: reads a file from stdin, in a process of its own.

Its arguments are the kind and type of the file, what it may be at most, what the process may take at most, and the
number of the descriptor that the answer goes to. Nothing else goes there, whatever a library prints.
"""

from __future__ import annotations

import math
import resource
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError

NAME = "culet.engine.library.upload_reader"
BESIDES = 2**25
"""Bytes that reading a sky takes besides the file, twice, and what is kept of it: rows, and the decoder's own."""


class ReadingOrder(NamedTuple):
    """What the process is told, as its arguments."""

    kind: str
    file_type: str
    answer: int
    """Descriptor."""
    max_triangles: int
    max_pixels: int
    memory: int
    """Bytes, besides what the program takes before it reads anything."""
    processor_seconds: int
    file_bytes: int
    """Of the largest file that the process may write, the answer among them."""

    def words(self) -> list[str]:
        """The command line."""
        return [str(value) for value in self]

    @classmethod
    def of(cls, words: list[str]) -> ReadingOrder:
        """What a command line says."""
        kind, file_type, *numbers = words
        return cls(kind, file_type, *(int(number) for number in numbers))


def main(words: list[str]) -> None:
    """Read, answer, end."""
    from culet.engine.library.upload_answer import AnswerFile

    order = ReadingOrder.of(words)
    answer = AnswerFile(order.answer)
    # all that reading needs is loaded before memory is limited
    if order.kind == "mesh":
        from culet.geometry.stone_file import shape_from_file
    else:
        from culet.optics.sky_files.reading import read_sky
    limit(order)

    def allocate(shape: tuple[int, int, int]) -> NDArray[np.float32]:
        """In the answer, unless memory will not do for it and for what reading takes besides."""
        needed = math.prod(shape) * 4 + 2 * len(data) + BESIDES
        if needed > order.memory:
            raise MemoryError(needed)
        return answer.allocate(shape)

    try:
        data = sys.stdin.buffer.read()
        if order.kind == "mesh":
            answer.tell_mesh(shape_from_file(data, order.file_type, max_triangles=order.max_triangles))
        else:
            answer.tell_sky(read_sky(data, order.file_type, max_pixels=order.max_pixels, allocate=allocate))
    except (InputError, MemoryError) as error:
        answer.refuse(error)


def limit(order: ReadingOrder) -> None:
    """What this process may take from here on; whatever is more ends it, or fails with MemoryError."""
    memory = address_space() + order.memory
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (order.processor_seconds, order.processor_seconds + 1))
    resource.setrlimit(resource.RLIMIT_FSIZE, (order.file_bytes, order.file_bytes))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def address_space() -> int:
    """Bytes of address space that this process has taken so far."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:  # not a Linux
        return 2**30
    return pages * resource.getpagesize()


if __name__ == "__main__":
    main(sys.argv[1:])
