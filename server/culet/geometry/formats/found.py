"""What a mesh file holds, as its reader found it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.errors import TooLargeError

CORNERS = 3
"""Vertices for each triangle that a file may have: no triangle can name more."""


@dataclass(frozen=True)
class MeshLimits:
    """How much a reader takes on before it refuses."""

    triangles: int

    @property
    def vertices(self) -> int:
        """More than the triangles could name."""
        return CORNERS * self.triangles

    def check_triangles(self, count: int) -> None:
        """TooLargeError if there are more."""
        if count > self.triangles:
            raise TooLargeError(f"expected at most {self.triangles} triangles, got {count} or more")

    def check_vertices(self, count: int) -> None:
        """TooLargeError if there are more."""
        if count > self.vertices:
            raise TooLargeError(
                f"expected at most {self.vertices} vertices, {CORNERS} for each triangle allowed, got {count} or more"
            )


@dataclass(frozen=True, eq=False)
class MeshPart:
    """One mesh of a file, where its scene shows it."""

    vertices: NDArray[np.float64]
    """(V, 3)."""
    triangles: NDArray[np.int64]
    """(T, 3) of `vertices`."""


@dataclass(frozen=True, eq=False)
class Found:
    """The meshes of a file."""

    parts: tuple[MeshPart, ...]
    findings: tuple[str, ...] = ()
    """What the reader left out or took otherwise than the file says, a sentence each."""
    doubt: str | None = None
    """What may be the cause if the surface turns out to be no stone."""


def fan(corners: list[int]) -> list[tuple[int, int, int]]:
    """The triangles of a polygon, from its first corner."""
    return [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]


def part_of(positions: list[tuple[float, float, float]], triangles: list[tuple[int, int, int]]) -> MeshPart:
    """The part of lists."""
    return MeshPart(
        np.array(positions, np.float64).reshape(-1, 3),
        np.array(triangles, np.int64).reshape(-1, 3),
    )


def counted(number: int, one: str, many: str) -> str:
    """The number with its noun."""
    return f"{number} {one if number == 1 else many}"
