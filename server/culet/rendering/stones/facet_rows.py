"""Facets of a convex stone as rows, each of which stands for eight, for four, two or one of them: what facet_rows.cl
follows light by.

Most cuts have an axis of half or quarter turns and mirrors along it, so that in the right axes facets differ in the
signs of x and z, and in which is which. A stone without symmetry has one row for each facet.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.geometry.symmetry import frames, images
from culet.rendering.opencl.device import Real
from culet.rendering.opencl.layout import constants

Array = NDArray[np.float64]

MOST_FACETS = 512
"""Of a stone whose symmetry is looked for, which takes some 50 ms. What has more is hardly ever cut."""
COSTS = 31.0, 22.0, 18.0, 18.0, 12.0
"""Instructions for a row of each kind, which is what limits the search."""
_KERNEL = constants("facet_rows.cl")
EIGHTS, FOURS, TURNED_TWOS, MIRRORED_TWOS, ONES = (
    _KERNEL[name] for name in ("EIGHTS", "FOURS", "TURNED_TWOS", "MIRRORED_TWOS", "ONES")
)
COLUMN_ROWS, HAIR = _KERNEL["COLUMN_ROWS"], _KERNEL["HAIR"]


@dataclass(frozen=True, eq=False)
class FacetRows:
    """Of one shape."""

    axes: Array
    """(3, 3) columns: the rows' axes in the shape's own."""
    rows: Array
    """(N, 4) normals and offsets, kind by kind."""
    ends: tuple[int, ...]
    """Where the rows of each kind end."""
    planes: Array
    """(F, 4) the facets as the rows have them, in the shape's own axes and order: images of each other exactly."""

    def data(self, real: Real) -> Array:
        """(M, 4) what facet_rows.cl reads, in that precision: rows whose offsets are a hair larger, the same exactly,
        and the first COLUMN_ROWS of them by component."""
        columns = np.zeros((4, COLUMN_ROWS))
        count = min(COLUMN_ROWS, len(self.rows))
        columns[:, :count] = self.rows[:count].T
        hair = np.array([0, 0, 0, HAIR * float(np.finfo(real).eps)])
        return np.concatenate([self.rows + hair, self.rows, columns.reshape(-1, 4)])


_ROWS: WeakKeyDictionary[Shape, FacetRows] = WeakKeyDictionary()


def has_facet_rows(shape: Shape) -> bool:
    """Whether `facet_rows` has them already."""
    return shape in _ROWS


def facet_rows(shape: Shape) -> FacetRows:
    """The rows that cost least, made once: symmetries are looked for, for some 50 ms."""
    rows = _ROWS.get(shape)
    if rows is None:
        rows = _ROWS[shape] = _cheapest(shape.planes)
    return rows


def _cheapest(planes: Array) -> FacetRows:
    if len(planes) > MOST_FACETS:
        count = len(planes)
        return FacetRows(np.eye(3), planes, (0, 0, 0, 0, count), planes)
    return min((_rows(planes, axes) for axes in frames(planes)), key=search_cost)


def search_cost(rows: FacetRows) -> float:
    """Instructions for the facet that a ray reaches first."""
    return float(np.diff([0, *rows.ends]) @ COSTS)


def _rows(planes: Array, axes: Array) -> FacetRows:
    turned = np.column_stack([planes[:, :3] @ axes, planes[:, 3]])
    same = np.empty_like(turned)
    rows: list[Array] = []
    ends: list[int] = []
    for kind, groups in enumerate(_groups(turned)):
        own: list[Array] = []
        for group in groups:
            carry = _carry(kind, turned[group])
            own.append(np.einsum("nij,nj->ni", carry, turned[group]).mean(axis=0))
            if kind == EIGHTS and len(group) == 4:
                own[-1][2] = 0
            same[group] = own[-1] @ carry  # what carries facets to their row carries it back to them
        if kind in (TURNED_TWOS, MIRRORED_TWOS):
            own += own[len(own) - len(own) % 2 :]
        rows += own
        ends.append(len(rows))
    same[:, :3] = same[:, :3] @ axes.T
    return FacetRows(axes, np.array(rows), tuple(ends), same)


def _carry(kind: int, planes: Array) -> Array:
    """(N, 4, 4) orthogonal: what carries the facets of a group of that kind, near these planes, to their row."""
    carry = np.tile(np.eye(4), (len(planes), 1, 1))
    if kind in (EIGHTS, FOURS):
        carry[:, 0, 0], carry[:, 2, 2] = np.where(planes[:, [0, 2]] < 0, -1, 1).T
    elif kind == TURNED_TWOS:
        carry[1, [0, 2], [0, 2]] = -1
    elif kind == MIRRORED_TWOS:
        carry[1, 0, 0] = -1
    if kind == EIGHTS:
        steep = np.abs(planes[:, 2]) > np.abs(planes[:, 0])
        carry[steep] = carry[steep][:, [2, 1, 0, 3]]
    return carry


def _groups(turned: Array) -> list[list[list[int]]]:
    """By kind of row: facets that share one, of which the first is like the row if there are one or two."""
    by_turn, by_x, by_z = (images(turned, np.diag(signs)) for signs in ((-1, 1, -1), (-1, 1, 1), (1, 1, -1)))
    exchange = images(turned, np.eye(3)[[2, 1, 0]])
    groups: list[list[list[int]]] = [[] for _ in COSTS]
    left = set(range(len(turned)))
    for facet in range(len(turned)):
        if facet not in left:
            continue
        half, x, z = (int(image[facet]) for image in (by_turn, by_x, by_z))
        four = {facet, half, x, z}
        eight = four | {int(exchange[each]) for each in four}
        axial = x == facet or z == facet
        if left >= eight and (len(eight) == 8 or (len(eight) == 4 and axial)):
            kind, group = EIGHTS, [*eight]
        elif left >= four and len(four) == 4:
            kind, group = FOURS, [*four]
        elif half in left - {facet}:
            kind, group = TURNED_TWOS, [facet, half]
        elif x in left - {facet}:
            kind, group = MIRRORED_TWOS, [facet, x]
        else:
            kind, group = ONES, [facet]
        groups[kind].append(group)
        left -= set(group)
    return groups
