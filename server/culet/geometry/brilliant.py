"""The round brilliant: 73 half-spaces in closed form from the trade's proportions.

A table, 8 stars, 8 kites and 16 upper halves make the crown; 16 facets the girdle; 16 lower halves and 8 mains the
pavilion, which ends in a point. Stars end on the line of the kites, halves meet at the girdle between two mains.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.shape import FacetName, Shape
from culet.scene.cuts import BrilliantCut

FACETS, VERTICES = 73, 57

_TIERS = ("table", "star", "kite", "upper half", "girdle", "lower half", "main")
"""From the table down."""
_OF_A_MAIN = ("kite", "star", "main", *2 * ("upper half", "lower half", "girdle"))
NAMES = tuple(FacetName(_TIERS.index(name) + 1, name) for name in ("table", *8 * _OF_A_MAIN))
"""Of each facet, in the order of `brilliant_planes`."""

_COS_HALF_STEP = math.cos(math.pi / 8)
"""Of 22.5 degrees, between a main's azimuth and a star's."""
_COS_QUARTER_STEP = math.cos(math.pi / 16)
"""Of 11.25 degrees, between a main's azimuth and a half's."""


def brilliant_planes(cut: BrilliantCut) -> NDArray[np.float64]:
    """(73, 4) outward unit normals and offsets, girdle radius 1, girdle about y = 0.

    Order: the table, then for each of the 8 mains its kite, star, main and two of upper half, lower half and girdle.
    MeshError if these proportions have no star facets.
    """
    table, star = cut.table_percent / 100, cut.star_percent / 100
    _require_stars(table, star)
    tan_crown, tan_main = (math.tan(math.radians(angle)) for angle in (cut.crown_degrees, cut.pavilion_degrees))
    half_girdle = cut.girdle_percent / 100  # of the diameter, so half of it in radii
    table_height = half_girdle + (1 - table) * tan_crown

    table_edge = table * _COS_HALF_STEP  # distance of the table's sides from the axis
    star_end = table_edge + star * (1 - table_edge)  # radius at which a star meets two kites and two upper halves
    tan_star = tan_crown * (star_end * _COS_HALF_STEP - table) / (star_end - table_edge)
    tan_upper = (1 - star_end * _COS_HALF_STEP) * tan_crown / (_COS_QUARTER_STEP * (1 - star_end))
    half_end = 1 - cut.lower_half_percent / 100
    tan_lower = (1 - half_end * _COS_HALF_STEP) * tan_main / (_COS_QUARTER_STEP * (1 - half_end))

    rows = [(0.0, 1.0, 0.0, table_height)]

    def add(azimuth: float, tan_tilt: float, radius: float, height: float, side: float) -> None:
        """The plane tilted from the horizontal that passes `radius` along its own azimuth at `height`."""
        sine, cosine = tan_tilt / math.hypot(1, tan_tilt), side / math.hypot(1, tan_tilt)
        normal = (sine * math.cos(azimuth), cosine, -sine * math.sin(azimuth))
        rows.append((*normal, sine * radius + cosine * height))

    for k in range(8):
        main = k * math.pi / 4
        add(main, tan_crown, 1, half_girdle, 1)
        add(main + math.pi / 8, tan_star, table_edge, table_height, 1)
        add(main, tan_main, 1, -half_girdle, -1)
        for azimuth in (main + math.pi / 16, main - math.pi / 16):
            add(azimuth, tan_upper, _COS_QUARTER_STEP, half_girdle, 1)
            add(azimuth, tan_lower, _COS_QUARTER_STEP, -half_girdle, -1)
            rows.append((math.cos(azimuth), 0.0, -math.sin(azimuth), _COS_QUARTER_STEP))
    return np.array(rows)


def brilliant(cut: BrilliantCut) -> Shape:
    """The shape of these proportions: 73 facets, 57 vertices. MeshError, naming the proportion, if there is none."""
    shape = shape_from_half_spaces("brilliant", brilliant_planes(cut), NAMES)
    if (len(shape.planes), len(shape.vertices)) != (FACETS, VERTICES):
        raise MeshError(
            f"brilliant: these proportions leave {len(shape.planes)} of {FACETS} facets and {len(shape.vertices)} of "
            f"{VERTICES} corners; the others are thinner than rounding. Got {_listing(cut)}"
        )
    return shape


def _require_stars(table: float, star: float) -> None:
    """Stars slope only if they end outside the octagon's corner: star_end cos 22.5 > table."""
    if table >= _COS_HALF_STEP:
        raise MeshError(
            f"brilliant: table_percent must be below {100 * _COS_HALF_STEP:.2f}, where stars have no room; "
            f"got {100 * table:g}",
            "table_percent",
        )
    table_edge = table * _COS_HALF_STEP
    least = (table / _COS_HALF_STEP - table_edge) / (1 - table_edge)
    if star <= least:
        raise MeshError(
            f"brilliant: star_percent must be above {100 * least:.2f} and below 100 with a table of {100 * table:g} %, "
            f"or the stars do not slope; got {100 * star:g}",
            "star_percent",
        )


def _listing(cut: BrilliantCut) -> str:
    return ", ".join(f"{key}={value:g}" for key, value in cut.model_dump(exclude={"name"}).items())
