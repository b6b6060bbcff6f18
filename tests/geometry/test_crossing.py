"""Pairs of triangles: which cross, which only touch; and polygons cut into ears."""

from __future__ import annotations

import numpy as np
import pytest

from culet.errors import TooLargeError
from culet.geometry import crossing
from culet.geometry.crossing import crossing_triangles
from culet.geometry.flat_regions import clip_ears
from geometry.shapes import Points, star_outline

FIRST = [(0, 0, 0), (2, 0, 0), (0, 2, 0)]


@pytest.mark.parametrize(
    ("second", "crosses"),
    [
        ([(0.5, 0.5, -1), (0.5, 0.5, 1), (3, 3, 0)], True),  # a side through the middle
        ([(1, 0, -1), (1, 0, 1), (1, -1, 0)], True),  # a side through a side
        ([(0, 0, -1), (0, 0, 1), (-1, -1, 0)], True),  # a side through a corner
        ([(-1, -1, -1), (5, 0.1, 1), (0.1, 5, 1)], True),  # sides of both
        ([(0.5, 0.5, 0), (0.5, 0.5, 1), (3, 3, 1)], False),  # a corner that touches
        ([(0.5, 0.5, -1e-8), (0.5, 0.5, 1), (3, 3, 1)], False),  # a corner deeper than rounding only by DEPTH / 100
        ([(0.5, 0.5, 0.1), (0.5, 0.5, 1), (3, 3, 0.1)], False),  # above
        ([(2, 2, -1), (2, 2, 1), (3, 3, 0)], False),  # beside
        ([(0.2, 0.2, 0), (0.6, 0.2, 0), (0.2, 0.6, 0)], True),  # in the plane, inside
        ([(1, -1, 0), (3, 1, 0), (1, 1, 0)], True),  # in the plane, overlapping
        ([(2, 0, 0), (2, 2, 0), (0, 2, 0)], False),  # in the plane, along a side
        ([(0, 0, 0), (-1, 0, 0), (0, -1, 0)], False),  # in the plane, at a corner
    ],
)
def test_two_triangles(second: list[tuple[float, float, float]], crosses: bool) -> None:
    corners = np.array([*FIRST, *second], np.float64) / 4
    for order in ([(0, 1, 2), (3, 4, 5)], [(3, 4, 5), (0, 1, 2)], [(2, 1, 0), (4, 5, 3)]):
        assert (crossing_triangles(corners, np.array(order)) is not None) is crosses


@pytest.mark.parametrize(("lifted", "crosses"), [(1.0, False), (-1.0, False), (0.0, True)])
def test_a_fold_over_a_common_side(lifted: float, crosses: bool) -> None:
    """Two triangles on one side of their common edge cover the same ground only if they are flat."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.7, lifted)], np.float64)
    assert (crossing_triangles(corners, np.array([(0, 1, 2), (1, 0, 3)])) is not None) is crosses


def test_a_crossing_is_found_among_many() -> None:
    """A grid of 20 000 triangles, and one that pierces it somewhere."""
    n = 101
    x, y = (grid.ravel() / n for grid in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    corners = np.column_stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)])
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    sheet = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    assert crossing_triangles(corners, sheet) is None
    needle = np.array([(0.301, 0.702, -1), (0.301, 0.702, 1), (0.301, 0.7021, 1)])
    found = crossing_triangles(np.vstack([corners, needle]), np.vstack([sheet, [[n * n, n * n + 1, n * n + 2]]]))
    assert found is not None
    assert len(sheet) in found


def test_a_heap_of_triangles_is_given_up_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crossing, "PAIRS_LIMIT", 100_000)
    corners = np.random.default_rng(2).normal(size=(3000, 3))
    with pytest.raises(TooLargeError, match="cannot be checked for crossing faces: its 1000 triangles"):
        crossing_triangles(corners, np.arange(3000).reshape(-1, 3))


def area(polygon: Points, ears: Points) -> tuple[float, float]:
    """Of the triangles together, and of the smallest."""
    a, b, c = (polygon[ears[:, k].astype(int)] for k in range(3))
    double = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return float(double.sum() / 2), float(double.min() / 2)


@pytest.mark.parametrize(
    ("polygon", "wanted"),
    [
        (star_outline(), 10 * 0.5 * 0.4 * np.sin(np.pi / 5)),
        (star_outline(40, 0.1), 80 * 0.5 * 0.1 * np.sin(np.pi / 40)),
        (np.array([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)], np.float64), 4.0),
        (np.array([(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)], np.float64), 7.0),
    ],
    ids=["star", "spiky star", "square with corners in line", "u"],
)
def test_ears_cover_a_simple_polygon_once(polygon: Points, wanted: float) -> None:
    for turn in range(len(polygon)):
        turned = np.roll(polygon, turn, axis=0)
        ears = clip_ears(turned)
        assert ears is not None
        assert len(ears) == len(polygon) - 2
        total, smallest = area(turned, ears.astype(np.float64))
        assert total == pytest.approx(wanted, rel=1e-12, abs=0)
        assert smallest > 0


def test_a_polygon_that_crosses_itself_has_no_ears_in_the_end() -> None:
    assert clip_ears(np.array([(0, 0), (2, 2), (2, 0), (0, 1.0)])) is None
