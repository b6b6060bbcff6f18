"""Facets of a convex stone as rows, each of which stands for four, for two or for one of them: what facet_rows.cl
follows light by.

Most cuts have an axis of half turns and mirrors along it, so that in the right axes facets differ in the signs of x and
z alone. A stone without symmetry has one row for each facet.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.geometry.symmetry import SAME, frames, images
from culet.rendering.device import Real
from culet.rendering.layout import constants

Array = NDArray[np.float64]

MOST_FACETS = 512
"""Of a stone whose symmetry is looked for, which takes some 50 ms. What has more is hardly ever cut."""
COSTS = 13.0, 16.0, 11.0, 11.0, 9.0
"""Multiplications and comparisons of a row of each kind: they share a port of the processor and take most time."""
HAIR = 2.5
"""Steps of a number next to 1, R, by which offsets are too large where light looks for the facet that it reaches first:
so the gap to the facet that it has just left is positive, however it was rounded."""
_KERNEL = constants("facet_rows.cl")
TIERS, FOURS, TURNED_TWOS, MIRRORED_TWOS, ONES = (
    _KERNEL[name] for name in ("TIERS", "FOURS", "TURNED_TWOS", "MIRRORED_TWOS", "ONES")
)
COLUMN_ROWS = _KERNEL["COLUMN_ROWS"]


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


def facet_rows(shape: Shape) -> FacetRows:
    """The rows that cost least, made once."""
    rows = _ROWS.get(shape)
    if rows is None:
        rows = _ROWS[shape] = _cheapest(shape.planes)
    return rows


def _cheapest(planes: Array) -> FacetRows:
    if len(planes) > MOST_FACETS:
        count = len(planes)
        return FacetRows(np.eye(3), planes, (0, 0, 0, 0, count), planes)
    return min((_rows(planes, axes) for axes in frames(planes)), key=_cost)


def _cost(rows: FacetRows) -> float:
    return float(np.diff([0, *rows.ends]) @ COSTS)


def _rows(planes: Array, axes: Array) -> FacetRows:
    turned = np.column_stack([planes[:, :3] @ axes, planes[:, 3]])
    same, rows, ends = np.empty_like(turned), [np.empty((0, 4))], []
    for kind, groups in enumerate(_groups(turned)):
        own = np.array([(turned[group] * _signs(kind, turned[group])).mean(axis=0) for group in groups]).reshape(-1, 4)
        if kind == TIERS:
            own = _levelled(own)
        for group, row in zip(groups, own, strict=True):
            same[group] = row * _signs(kind, turned[group])
        rows.append(own)
        if kind != ONES:
            rows.append(own[len(own) - len(own) % 2 :])
        ends.append(sum(map(len, rows)))
    same[:, :3] = same[:, :3] @ axes.T
    return FacetRows(axes, np.concatenate(rows), tuple(ends), same)


def _signs(kind: int, planes: Array) -> Array:
    """By which a row of that kind becomes its facets, which are near these."""
    signs = np.ones_like(planes)
    if kind in (TIERS, FOURS):
        signs[:, [0, 2]] = np.where(planes[:, [0, 2]] < 0, -1, 1)
    elif kind == TURNED_TWOS:
        signs[1, [0, 2]] = -1
    elif kind == MIRRORED_TWOS:
        signs[1, 0] = -1
    return signs


def _levelled(tiers: Array) -> Array:
    """With the same y and offset in both rows of each two, and normals of unit length."""
    level = tiers[:, [1, 3]].reshape(-1, 2, 2).mean(axis=1).repeat(2, axis=0)
    across = tiers[:, [0, 2]] * np.sqrt((1 - level[:, :1] ** 2) / (tiers[:, [0, 2]] ** 2).sum(axis=1, keepdims=True))
    return np.column_stack([across[:, 0], level[:, 0], across[:, 1], level[:, 1]])


def _groups(turned: Array) -> list[list[list[int]]]:
    """By kind of row: facets that share one, of which the first is like the row."""
    by_turn, by_x, by_z = (images(turned, signs) for signs in ((-1, 1, -1), (-1, 1, 1), (1, 1, -1)))
    groups: list[list[list[int]]] = [[] for _ in COSTS]
    left = set(range(len(turned)))
    for facet in range(len(turned)):
        if facet not in left:
            continue
        half, x, z = (int(image[facet]) for image in (by_turn, by_x, by_z))
        others = left - {facet}
        if len({half, x, z}) == 3 and others >= {half, x, z}:
            kind, group = FOURS, [facet, half, x, z]
        elif half in others:
            kind, group = TURNED_TWOS, [facet, half]
        elif x in others:
            kind, group = MIRRORED_TWOS, [facet, x]
        else:
            kind, group = ONES, [facet]
        groups[kind].append(group)
        left -= set(group)
    waiting = sorted(groups[FOURS], key=lambda four: (*np.round(turned[four[0], [1, 3]], 5),))
    groups[FOURS] = []
    while waiting:
        four = waiting.pop()
        if waiting and np.abs(turned[four[0], [1, 3]] - turned[waiting[-1][0], [1, 3]]).max() < SAME:
            groups[TIERS] += [four, waiting.pop()]
        else:
            groups[FOURS].append(four)
    return groups
