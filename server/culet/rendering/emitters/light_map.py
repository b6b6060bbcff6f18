"""Where the texels of a light map lie: what shadows and caustics add to the unshaded light of floor and walls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.rendering.emitters.sources import mapped_surfaces
from culet.rendering.room.surfaces import room_surfaces
from culet.rendering.stones.placed_stone import extent_of, placed_stones
from culet.stage import Stage

Array = NDArray[np.float64]

SURFACES = 4
"""The floor, and three walls."""
LEVELS = 2
SIZE = 512
"""Rows and columns of a level."""
CHANNELS = 3
ABOUT = 2.0
"""R about the stones that the finer level reaches: 54 % of the light that a stone throws down lands there."""
COARSER = 4.0
"""Half size of the coarser level over that of the finer: 88 % of the light lands on both."""


@dataclass(frozen=True)
class MappedSurface:
    """A surface of the room as a plane with two axes: u along it, v across (of a wall: up)."""

    normal: tuple[float, float, float]
    """Inward."""
    offset: float
    """The room is n.x >= offset."""
    along: tuple[float, float, float]
    across: tuple[float, float, float]

    def coordinates(self, points: Array) -> Array:
        """(..., 2) u and v of points (..., 3)."""
        return np.asarray(points @ np.array([self.along, self.across]).T)

    def point(self, u: float, v: float) -> Array:
        """(3,) where u and v are."""
        return np.array(self.normal) * self.offset + np.array(self.along) * u + np.array(self.across) * v


@cache
def surfaces() -> tuple[MappedSurface, ...]:
    """Of the room, in the world: (x, z) on the floor; along the wall and y on a wall, as checkers are counted."""
    found = []
    for number, (x, y, z, offset) in enumerate(room_surfaces(np.zeros(3))):
        along, across = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)) if number == 0 else ((z, 0.0, -x), (0.0, 1.0, 0.0))
        found.append(MappedSurface((x, y, z), offset, along, across))
    return tuple(found)


@dataclass(frozen=True)
class MapFrame:
    """Where the maps of a stage lie in the world. Equal frames have equal maps' places."""

    matte: tuple[int, ...]
    """Numbers of the surfaces that have a map."""
    middle: tuple[float, float, float]
    """Of the stones, R."""
    centres: tuple[tuple[float, float], ...]
    """(u, v) of the middle of each surface's map, R."""
    halves: tuple[float, float]
    """Half the size of each level, R."""

    @property
    def held(self) -> int:
        """Surfaces that the buffer has: only the floor, or all."""
        return held_surfaces(self.matte)

    @property
    def shape(self) -> tuple[int, int, int, int, int]:
        """Of the buffer: float32 by surface, level, row (v), column (u) and channel."""
        return self.held, LEVELS, SIZE, SIZE, CHANNELS

    @property
    def nbytes(self) -> int:
        """Of the buffer."""
        return map_bytes(self.matte)

    def texels(self, surface: int, level: int) -> tuple[Array, Array]:
        """(SIZE,) u of the columns' middles, and v of the rows'."""
        steps = self.halves[level] * ((np.arange(SIZE) + 0.5) * 2 / SIZE - 1)
        return self.centres[surface][0] + steps, self.centres[surface][1] + steps

    def texel_area(self, level: int) -> float:
        """R^2."""
        return (2 * self.halves[level] / SIZE) ** 2


def held_surfaces(matte: Sequence[int]) -> int:
    """Surfaces that a map's buffer has for these: none, only the floor, or all."""
    return max(matte, default=-1) + 1 if max(matte, default=0) == 0 else SURFACES


def map_bytes(matte: Sequence[int]) -> int:
    """Of a map's buffer for these surfaces: float32 by surface, level, row, column and channel."""
    return 4 * held_surfaces(matte) * LEVELS * SIZE * SIZE * CHANNELS


def frame_of(stage: Stage) -> MapFrame:
    """The frame for where the stones are."""
    stones = placed_stones(stage)
    weights = np.array([stone.scale**2 for stone in stones])
    middle = np.zeros(3)
    if stones:
        middle = np.sum([w * stone.centre for w, stone in zip(weights, stones, strict=True)], axis=0) / weights.sum()
    half = ABOUT + (extent_of(stones, middle) if stones else 1.0)
    centres = tuple((float(u), float(v)) for u, v in (surface.coordinates(middle) for surface in surfaces()))
    x, y, z = (float(component) for component in middle)
    return MapFrame(mapped_surfaces(stage), (x, y, z), centres, (half, COARSER * half))


class BoundMap:
    """A map on the device, and where it lies."""

    def __init__(self, frame: MapFrame, allocate: Callable[[int], Any]) -> None:
        """`allocate` makes its buffer, of so many bytes, when that is first asked for."""
        self.frame = frame
        self._allocate = allocate
        self._buffer: Any = None

    @property
    def buffer(self) -> Any:  # noqa: ANN401 - pyopencl has no types
        """Float32 of `frame.shape`; what is there means nothing before somebody has written it."""
        if self._buffer is None:
            self._buffer = self._allocate(self.frame.nbytes)
        return self._buffer


@dataclass(frozen=True)
class Figures:
    """What a pass has counted: fluxes in R^2 times irradiance over pi, mean of the channels."""

    incident: float
    """That meets stones."""
    cut: float
    """That was dropped below the cut-off."""
    unresolved: float
    """That was not followed for another reason."""
    outside: float
    """That lands on a matte surface beyond its map."""
    rmse: float
    """Estimated, of the map's finer levels, in irradiance over pi; NaN if a pass by itself does not tell."""
    seconds: float
    """Spent."""

    @property
    def bound(self) -> float:
        """The part of the light that may be missing: strict."""
        return (self.cut + self.unresolved + self.outside) / self.incident if self.incident > 0 else 0.0
