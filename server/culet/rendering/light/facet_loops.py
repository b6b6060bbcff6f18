"""Facets of a convex shape as loops of corners, with the facet beyond each side: how beams find their way."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from culet.geometry.polygons import edges_of_facets
from culet.geometry.shape import Shape

Ints = NDArray[np.int32]

MOST_CORNERS = 16
"""Of a beam as it enters a stone: a facet of more is entered in parts."""


@dataclass(frozen=True, eq=False)
class FacetLoops:
    """Corners of the facets, counter-clockwise seen from outside, one facet after the other."""

    start: Ints
    """(F + 1,) where each facet's corners begin."""
    corners: Ints
    """(C,) vertices."""
    across: Ints
    """(C,) the facet beyond the side that begins at a corner."""
    entries: Ints
    """(E, 3) facet, and of its corners, besides the first, from which one on how many there are, the first included."""


_known: WeakKeyDictionary[Shape, FacetLoops] = WeakKeyDictionary()


def facet_loops(shape: Shape) -> FacetLoops:
    """Of a convex shape; made once."""
    found = _known.get(shape)
    if found is None:
        found = _known[shape] = _loops(shape)
    return found


def _loops(shape: Shape) -> FacetLoops:
    following: list[dict[int, tuple[int, int]]] = [{} for _ in shape.planes]
    for v0, v1, a, b in edges_of_facets(shape).tolist():
        following[a][v0] = v1, b
        following[b][v1] = v0, a
    start, corners, across = [0], [], []
    entries = []
    for facet, sides in enumerate(following):
        at = begin = next(iter(sides), -1)
        count = 0
        while at in sides and count < len(sides):
            corners.append(at)
            at, beyond = sides[at]
            across.append(beyond)
            count += 1
            if at == begin:
                break
        start.append(len(corners))
        step = MOST_CORNERS - 2
        entries += [(facet, first, 1 + min(step + 1, count - first)) for first in range(1, count - 1, step)]
    return FacetLoops(
        np.array(start, np.int32),
        np.array(corners, np.int32),
        np.array(across, np.int32),
        np.array(entries, np.int32).reshape(-1, 3),
    )
