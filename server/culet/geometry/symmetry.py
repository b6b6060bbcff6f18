"""Half turns and mirrors that carry facets of a stone onto each other, wherever their axes lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]

SAME = 2e-6
"""By how much normals and offsets (R) may differ that count as images of each other: files in single precision round
corners by 6e-8 R, and with them the normals of facets that are a hundredth of R wide by some 6e-6 at most."""
_CELL = 1e-4
"""Size of the cells in which directions that agree are counted."""
_MOST_AXES, _MOST_MIRRORS = 4, 10
"""That are tried, the most frequent first. In a cut of order n the n mirrors are of two kinds at most."""


def frames(planes: Array) -> list[Array]:
    """Right-handed axes as columns, (3, 3) each, in which facets may be images of each other by signs: y is an axis of
    half turns where there is one, and x is across a mirror. The given axes come first."""
    first, second = np.triu_indices(len(planes))
    alike = np.abs(planes[first, 3] - planes[second, 3]) < SAME
    a, b = planes[first[alike], :3], planes[second[alike], :3]
    axes = _directions(a + b, _MOST_AXES)  # where a facet turns into another, or into itself
    mirrors = _directions(a - b, _MOST_MIRRORS)
    found = [np.eye(3)]
    for axis in axes:
        across = [mirror for mirror in mirrors if abs(mirror @ axis) < _CELL]
        found += [_frame(axis, mirror) for mirror in across or [_any_across(axis)]]
    found += [_frame(_any_across(mirror), mirror) for mirror in mirrors]
    return found


def images(planes: Array, carry: Array) -> NDArray[np.int64]:
    """(F,) the facet that is each one's image when its normal is carried so, (3, 3); -1 where there is none."""
    carried = np.column_stack([planes[:, :3] @ carry.T, planes[:, 3]])
    apart, nearest = cKDTree(planes).query(carried, p=np.inf)
    return np.where(apart < SAME, nearest, -1)


def _frame(y: Array, x: Array) -> Array:
    x = x - (x @ y) * y
    x /= np.linalg.norm(x)
    return np.column_stack([x, y, np.cross(x, y)])


def _any_across(direction: Array) -> Array:
    """A unit vector at right angles."""
    across = np.cross(direction, np.eye(3)[int(np.abs(direction).argmin())])
    return np.asarray(across / np.linalg.norm(across))


def _directions(vectors: Array, most: int) -> list[Array]:
    """The most frequent directions of these vectors, whichever way they point, that at least two have."""
    lengths = np.linalg.norm(vectors, axis=1)
    units = vectors[lengths > _CELL] / lengths[lengths > _CELL, None]
    leading = np.abs(units).argmax(axis=1) if len(units) else np.zeros(0, np.int64)
    units *= np.sign(units[np.arange(len(units)), leading])[:, None]
    cells = np.round(units / _CELL).astype(np.int64) @ [1, 2**20, 2**40]
    _, members, counts = np.unique(cells, return_inverse=True, return_counts=True)
    frequent = np.argsort(-counts, kind="stable")[:most]
    means = [units[members == cell].mean(axis=0) for cell in frequent if counts[cell] > 1]
    return [mean / np.linalg.norm(mean) for mean in means]
