"""The stones as beams meet them: facets as planes and as loops of corners, placed in the kernels' frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.light.facet_loops import facet_loops
from culet.rendering.opencl.device import Real
from culet.rendering.opencl.layout import struct
from culet.rendering.stones.placed_stone import PlacedStone
from culet.stage import Stage

ABREAST = 16
"""Planes that are looked at at a time: each stone's number is filled up to a multiple."""
SUNK = 1e-3
"""R that a stone may reach through a surface and throw its shadow as if it did not: a tenth of the finest texel."""
FEW, MANY = 96, 512
"""Facets of a stone that the programs for beams are made for."""


def takes_beams(shape: Shape) -> bool:
    """Whether light goes through it in beams: it is convex, and each of its lit facets is worth a beam."""
    return shape.convex and len(shape.planes) <= MANY


def takes_only_beams(stage: Stage) -> bool:
    """Whether all stones are such that beams are followed, or else photons."""
    return all(map(takes_beams, stage.shapes))


@dataclass(frozen=True, eq=False)
class Solids:
    """Arrays by the kernels' names."""

    solids: NDArray[np.void]
    planes: NDArray[np.floating[Any]]
    vertices: NDArray[np.floating[Any]]
    start: NDArray[np.int32]
    corners: NDArray[np.int32]
    across: NDArray[np.int32]
    entries: NDArray[np.int32]
    """(E, 4) stone, and a part of its surface: see FacetLoops."""
    most_facets: int
    """FEW or MANY."""
    sunk: bool
    """Whether one reaches through a surface by more than SUNK."""

    @classmethod
    def of(
        cls,
        stones: Sequence[PlacedStone],
        first_chains: Sequence[int],
        origin: NDArray[np.float64],
        surfaces: NDArray[np.float64],
        real: Real,
    ) -> Solids:
        """Relative to the origin, as the (S, 4) surfaces of the room are."""
        rows = np.zeros(max(1, len(stones)), struct("solid_t", real, "light_beam.cl"))
        planes, vertices, starts, corners, across, entries = [], [], [], [], [], []
        plane = vertex = corner = entry = facet = 0
        least = 0.0
        for number, (row, stone, chain) in enumerate(zip(rows, stones, first_chains, strict=False)):
            loops, shape, centre = facet_loops(stone.shape), stone.shape, stone.centre - origin
            count = len(shape.planes)
            padded = -(-count // ABREAST) * ABREAST
            placed = np.zeros((4, padded))
            placed[3] = 1
            own = stone.planes
            placed[:3, :count] = own[:, :3].T
            placed[3, :count] = stone.scale * own[:, 3] + own[:, :3] @ centre
            points = stone.scale * stone.vertices + centre
            row["centre"], row["radius"] = centre, stone.scale
            row["first_facet"], row["facets"] = facet, count
            row["first_plane"], row["padded"] = plane, padded
            row["first_vertex"], row["vertices"] = vertex, len(points)
            row["first_entry"], row["last_entry"] = entry, entry + len(loops.entries)
            row["first_chain"] = chain
            gap = float((points @ surfaces[:, :3].T - surfaces[:, 3]).min(initial=0))
            row["pierces"], least = gap < 0, min(least, gap)
            planes.append(placed.ravel())
            vertices.append(points)
            starts.append(loops.start[:-1] + corner)
            corners.append(loops.corners + vertex)
            across.append(loops.across)
            entries.append(np.column_stack([np.full(len(loops.entries), number, np.int32), loops.entries]))
            plane, vertex, facet = plane + 4 * padded, vertex + len(points), facet + count
            corner, entry = corner + len(loops.corners), entry + len(loops.entries)
        starts.append(np.array([corner], np.int32))
        most = max((len(stone.shape.planes) for stone in stones), default=0)
        return cls(
            rows,
            np.concatenate([*planes, np.zeros(1)]).astype(real),
            np.concatenate([*vertices, np.zeros((1, 3))]).astype(real),
            np.concatenate(starts).astype(np.int32),
            np.concatenate([*corners, np.zeros(1, np.int32)]).astype(np.int32),
            np.concatenate([*across, np.zeros(1, np.int32)]).astype(np.int32),
            np.concatenate([*entries, np.zeros((1, 4), np.int32)]).astype(np.int32),
            FEW if most <= FEW else MANY,
            least < -SUNK,
        )
