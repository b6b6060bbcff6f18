"""Rows of rhombs: the Portuguese cut and the briolette.

The first row of n facets stands on the girdle's edges, the second in its corners, and row j + 2 passes the points where
the facets of row j end between two of row j + 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from culet.errors import MeshError
from culet.geometry.cuts.facets import Facets
from culet.scene.cuts import BrioletteCut, PortugueseCut


class _Row(NamedTuple):
    slope: float
    """Tangent of its angle from the horizontal."""
    radius: float
    """Along its own azimuth, of a point that its facets pass, and this point's height."""
    height: float
    half_steps: int
    """Whether it stands on the edges (0) or in the corners (1)."""


def portuguese(cut: PortugueseCut) -> Facets:
    """Rows above the girdle that a table ends, rows below that end in a point. MeshError if a row has no room."""
    half_girdle, n = cut.girdle_percent / 100, cut.sides
    facets = Facets(cut.name)
    crown = _rows(cut.name, n, _between(cut.crown_degrees, cut.crown_top_degrees, cut.crown_rows), half_girdle, 1)
    last = crown[-1]
    facets.add_plane("table", np.array([0, 0, 1.0]), last.height + last.slope * (last.radius - cut.table_percent / 100))
    for number in reversed(range(len(crown))):
        _add_row(facets, f"crown {number + 1}", n, crown[number], 1)
    for k in range(n):
        azimuth = 2 * math.pi * k / n
        facets.add_plane("girdle", np.array([math.cos(azimuth), math.sin(azimuth), 0]), math.cos(math.pi / n))
    slopes = _between(cut.pavilion_degrees, cut.culet_degrees, cut.pavilion_rows)
    for number, row in enumerate(_rows(cut.name, n, slopes, -half_girdle, -1), 1):
        _add_row(facets, f"pavilion {number}", n, row, -1)
    facets.corners = 2 * n + cut.crown_rows * n + (cut.pavilion_rows - 1) * n + 1
    return facets


def briolette(cut: BrioletteCut) -> Facets:
    """Rows above and below, whose first share their corners, to a point each. MeshError if a row has no room."""
    n = cut.sides
    facets = Facets(cut.name)
    upper = _rows(cut.name, n, _between(cut.upper_degrees, cut.tip_degrees, cut.upper_rows), 0, 1)
    lower = _rows(cut.name, n, _between(cut.lower_degrees, cut.base_degrees, cut.lower_rows), 0, -1)
    for number in reversed(range(len(upper))):
        _add_row(facets, f"upper {number + 1}", n, upper[number], 1)
    for number, row in enumerate(lower, 1):
        _add_row(facets, f"lower {number}", n, row, -1)
    facets.corners = (cut.upper_rows + cut.lower_rows - 1) * n + 2
    return facets


def _between(first: float, last: float, rows: int) -> list[float]:
    return [float(angle) for angle in np.linspace(first, last, rows)]


def _rows(name: str, n: int, degrees: list[float], z: float, side: int) -> list[_Row]:
    """From the girdle's corners, at radius 1 and height z, up (side 1) or down (-1)."""
    cosine = math.cos(math.pi / n)
    slopes = [math.tan(math.radians(angle)) for angle in degrees]
    rows = [_Row(slopes[0], cosine, z, 0), _Row(slopes[1], 1.0, z, 1)]
    for slope in slopes[2:]:
        first, second = rows[-2:]
        # Along the first row's azimuth: where its height is that of the two neighbours of the second row.
        rise = side * (second.height - first.height) + second.slope * second.radius - first.slope * first.radius
        radius = rise / (second.slope * cosine - first.slope) if second.slope * cosine != first.slope else math.inf
        height = first.height + side * first.slope * (first.radius - radius)
        rows.append(_Row(slope, radius, height, first.half_steps))
    if not all(0 < row.radius <= 1 for row in rows):
        raise MeshError(f"{name}: a row has no room; slopes must fall enough from row to row")
    return rows


def _add_row(facets: Facets, label: str, n: int, row: _Row, side: int) -> None:
    sine, cosine = row.slope / math.hypot(1, row.slope), side / math.hypot(1, row.slope)
    for k in range(n):
        azimuth = (2 * k + row.half_steps) * math.pi / n
        normal = np.array([sine * math.cos(azimuth), sine * math.sin(azimuth), cosine])
        facets.add_plane(label, normal, sine * row.radius + cosine * row.height)
