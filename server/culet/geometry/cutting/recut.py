"""A convex stone cut anew: crown and pavilion by their tangent ratios, the girdle's height, angles, the table's
size.

A cutter's way to fit a design to another material without solving its meets again is the tangent ratio: a stretch of
the crown, or of the pavilion, along the axis multiplies the tangent of each facet's angle by one number. As the stretch
maps planes to planes, facets that met in a point still do; places on the index wheel and the girdle's outline stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from culet.errors import MeshError
from culet.geometry.cutting.meets import with_angles
from culet.geometry.half_spaces import Intersection, intersection
from culet.geometry.shape import FacetName, Shape
from culet.scene.recut import Recut

Array = NDArray[np.float64]

LEVEL = 1e-9
"""A component of a unit normal below this is a rounded 0."""
SAME_CORNER = 1e-4
"""In units of the stone's extent: heights nearer than this are one, since files round angles to 0.01 degrees."""
TABLE = "T"
"""What a table is called that is cut where there was none."""

OF_A_SHAPE = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], np.float64)
"""From the axes of a shape, y up, to those of a cutter, z up."""


@lru_cache(maxsize=64)
def recut_shape(shape: Shape, recut: Recut) -> Shape:
    """The shape cut anew, centred and scaled to circumradius 1 like any other. MeshError names the proportion that
    cannot be, or says that the stone is not convex."""
    if not recut.changes:
        return shape
    if not shape.convex:
        raise MeshError(f"{shape.name}: expected a convex stone to cut anew; got one that is not")
    names = list(shape.names)
    tiers = [name.tier for name in names]
    planes, gone = recut_planes(shape.name, shape.planes @ OF_A_SHAPE.T, recut, tiers)
    if names and len(planes) > len(names):
        names.append(FacetName(max(name.tier for name in names) + 1, TABLE))
    cut = intersection(shape.name, planes @ OF_A_SHAPE)
    findings = (*shape.findings, *said_of(gone))
    return cut.shape(shape.name, findings, names)


def said_of(gone: int) -> list[str]:
    """What is told of facets that the table has cut away."""
    return [f"Cut anew, {gone} of its facets bound nothing."] if gone else []


def recut_planes(name: str, planes: Array, recut: Recut, tiers: Sequence[int]) -> tuple[Array, int]:
    """(F, 4) planes of a closed convex stone, z up, cut anew in their order, then a table if there was none; and how
    many more of them than before bound nothing. `tiers` has the number of each facet's, or nothing. MeshError names the
    proportion that cannot be."""
    stone = _Stone(name, planes)
    before = len(stone.cut.used)
    for proportion in ("crown_ratio", "pavilion_ratio"):
        ratio = getattr(recut, proportion)
        if ratio != 1:
            stone = stone.stretched(proportion, ratio)
    if recut.girdle_percent is not None:
        stone = stone.with_girdle(recut.girdle_percent)
    if len(stone.cut.used) < before:
        raise MeshError(f"{name}: so cut, facets of the stone are lost", "crown_ratio")
    if recut.angles:
        stone = _Stone(name, with_angles(name, stone.cut.planes, tiers, recut.angles))
    if recut.table_percent is not None:
        before += len(stone.cut.planes) - len(planes)
        stone = stone.with_table(recut.table_percent)
        before += len(stone.cut.planes) - len(planes)
    return stone.cut.planes, before - len(stone.cut.used)


class _Stone:
    """Half-spaces, the solid that they enclose, and where its girdle is."""

    def __init__(self, name: str, planes: Array) -> None:
        self.name = name
        self.cut: Intersection = intersection(name, planes)
        rise = self.cut.planes[:, 2]
        used = np.zeros(len(rise), bool)
        used[self.cut.used] = True
        self.up, self.down = rise > LEVEL, rise < -LEVEL
        self.upright = used & ~self.up & ~self.down
        corners = self.cut.vertices
        self.extent = np.ptp(corners, axis=0)
        self.across = int(self.extent[1] < self.extent[0])
        self.width = float(self.extent[self.across])
        above, below, beside = (self._corners(which & used) for which in (self.up, self.down, self.upright))
        self.top, self.bottom = corners[sorted(above & beside), 2], corners[sorted(below & beside), 2]
        """Heights of the girdle's corners."""
        self.keen = corners[sorted(above & below), 2]
        """Heights where crown and pavilion meet without a girdle between them."""

    def _corners(self, which: NDArray[np.bool_]) -> set[int]:
        return {corner for facet in np.flatnonzero(which) for corner in self.cut.polygons[facet]}

    def stretched(self, proportion: str, ratio: float) -> _Stone:
        """The crown or the pavilion stretched about the girdle's edge on its side, at its thinnest place."""
        of_crown = proportion == "crown_ratio"
        edge = self.top if of_crown else self.bottom
        if len(edge):
            level = float(edge.min() if of_crown else edge.max())
        elif len(self.keen):
            level = float(self.keen.mean())
        else:
            raise MeshError(f"{self.name}: {proportion}: the stone has no girdle to keep", proportion)
        if len(self.keen) and abs(self.keen - level).max() > SAME_CORNER * self.extent.max():
            raise MeshError(
                f"{self.name}: {proportion}: expected 1, since crown and pavilion meet at several heights without a "
                f"girdle between them; got {ratio:g}", proportion,
            )  # fmt: skip
        planes = self.cut.planes.copy()
        side = self.up if of_crown else self.down
        rise = planes[side, 2]
        planes[side, 3] += rise * (1 / ratio - 1) * level
        planes[side, 2] = rise / ratio
        planes[side] /= np.linalg.norm(planes[side, :3], axis=1)[:, None]
        level_facets = side & (np.hypot(planes[:, 0], planes[:, 1]) < LEVEL)
        planes[level_facets, :3] = [0, 0, 1 if of_crown else -1]
        return _Stone(self.name, planes)

    def with_girdle(self, percent: float) -> _Stone:
        """The crown moved along the axis."""
        if not len(self.top) or not len(self.bottom):
            raise MeshError(f"{self.name}: girdle_percent: the stone has no girdle; got {percent:g}", "girdle_percent")
        thickness = float(self.top.max() - self.bottom.min())
        lift = percent / 100 * self.width - thickness
        thinnest = min(self._thinnest(facet) for facet in np.flatnonzero(self.upright))
        if lift <= -thinnest + 1e-9 * self.width and lift < 0:
            least = 100 * (thickness - thinnest) / self.width
            raise MeshError(
                f"{self.name}: girdle_percent: expected more than {least:.4g}, where its thinnest place is nothing; "
                f"got {percent:g}", "girdle_percent",
            )  # fmt: skip
        planes = self.cut.planes.copy()
        planes[self.up, 3] += planes[self.up, 2] * lift
        return _Stone(self.name, planes)

    def _thinnest(self, facet: np.intp) -> float:
        """Height of an upright facet at the lower of its two ends: between them it is higher, being convex."""
        corners = self.cut.vertices[self.cut.polygons[facet]]
        along = corners[:, :2] @ [-self.cut.planes[facet, 1], self.cut.planes[facet, 0]]
        near = SAME_CORNER * np.ptp(along)
        ends = (along <= along.min() + near, along >= along.max() - near)
        return min(float(np.ptp(corners[end, 2])) for end in ends)

    def with_table(self, percent: float) -> _Stone:
        """The table at the height at which the stone is so wide."""
        planes = self.cut.planes
        level = (planes[:, 2] > 0) & (np.hypot(planes[:, 0], planes[:, 1]) < LEVEL)
        others = planes[~level]
        wanted = percent / 100 * self.width
        height = _highest(others, self.across, wanted)
        if height is None:
            raise MeshError(
                f"{self.name}: table_percent: expected a crown that closes above a table; got {percent:g} for a stone "
                "without one", "table_percent",
            )  # fmt: skip
        table = np.array([0.0, 0.0, 1.0, height])
        if not level.any():
            return _Stone(self.name, np.vstack([planes, table]))
        moved = planes.copy()
        moved[np.flatnonzero(level)[moved[level, 3].argmin()]] = table
        return _Stone(self.name, moved)


def _highest(planes: Array, across: int, width: float) -> float | None:
    """The greatest height at which two points of a stone are so far apart along an axis; None if there is none, or no
    greatest: a linear programme in both points and their height."""
    count = len(planes)
    normal, rise = planes[:, :2], planes[:, 2:3]
    none = np.zeros((count, 2))
    apart = np.zeros((1, 5))
    apart[0, across], apart[0, 2 + across] = 1, -1
    rows = np.vstack([np.hstack([normal, none, rise]), np.hstack([none, normal, rise]), apart])
    limits = np.concatenate([planes[:, 3], planes[:, 3], [-width]])
    answer = linprog([0, 0, 0, 0, -1], A_ub=rows, b_ub=limits, bounds=[(None, None)] * 5, method="highs")
    return float(answer.x[4]) if answer.status == 0 else None
