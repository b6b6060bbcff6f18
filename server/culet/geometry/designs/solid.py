"""The stone of a design: its facets' half-spaces kept exactly, and what was found about them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import KDTree

from culet.errors import MeshError
from culet.geometry.designs.design import Design, Facet
from culet.geometry.half_spaces import Intersection, intersection
from culet.geometry.shape import FacetName, Shape

Planes = NDArray[np.float64]

SAME_PLANE = 1e-9
"""Normals, and distances in units of the largest, nearer than this are one plane: files have 8 decimals or more."""

LONGEST_NAME = 32
"""Characters of a facet's name that the shape keeps; cutters' names have one to ten."""


class Solid:
    """The half-spaces of a design, each once, and the solid that they enclose, in the design's own frame."""

    def __init__(self, design: Design) -> None:
        """MeshError if the facets enclose none, which says where they leave it open."""
        listed = list(design.facets())
        planes = design.planes()
        kept = _distinct(planes)
        self.design = design
        self.duplicates = len(planes) - len(kept)
        self.facets: list[tuple[int, Facet]] = [listed[k] for k in kept]
        """With their tiers' numbers, counted from 1, in the order of `cut.planes`."""
        self.cut = _enclosed(planes[kept])

    def names(self) -> list[FacetName]:
        """Of each half-space."""
        return [FacetName(tier, facet.name[:LONGEST_NAME]) for tier, facet in self.facets]

    def findings(self) -> list[str]:
        """What is in the file, and what of it the stone does not have."""
        design, used = self.design, self.cut.used
        title = f"{design.title[:80]}: " if design.title else ""
        offset = f", offset {design.wheel.offset:g}" if design.wheel.offset else ""
        tiers = counted(len(design.tiers), "tier")
        found = [f"{title}{len(used)} facets in {tiers} on a wheel of {design.wheel.teeth}{offset}."]
        if design.refractive_index is not None:
            found.append(f"Made for a refractive index of {design.refractive_index:g}; the stone keeps its material.")
        found += design.findings
        if self.duplicates:
            found.append(f"{counted(self.duplicates, 'facet')} given more than once; kept once.")
        return found + self._cut_away(used)

    def _cut_away(self, used: Sequence[int]) -> list[str]:
        gone = sorted(set(range(len(self.facets))) - set(used))
        if not gone:
            return []
        tiers = list(dict.fromkeys(self.facets[k][0] for k in gone))
        said = ", ".join(self._tier(number) for number in tiers[:5]) + (" and others" if len(tiers) > 5 else "")
        return [f"{counted(len(gone), 'facet')} cut away by others or never met, of {said}."]

    def _tier(self, number: int) -> str:
        tier = self.design.tiers[number - 1]
        about = [tier.name] * bool(tier.name) + ([f"line {tier.line}"] if tier.line is not None else [])
        return f"tier {number}" + (f" ({', '.join(about)})" if about else "")


def shape_of_design(design: Design, name: str = "design") -> Shape:
    """The stone, its table up and index 0 away from a viewer at +z, scaled to circumradius 1; traced by half-spaces.

    MeshError if the facets enclose no solid.
    """
    solid = Solid(design)
    x, y, z, distance = solid.cut.planes.T
    corners = solid.cut.vertices
    turned = Intersection(
        np.column_stack([x, z, -y, distance]),
        np.column_stack([corners[:, 0], corners[:, 2], -corners[:, 1]]),
        solid.cut.polygons,
    )
    return turned.shape(name, solid.findings(), solid.names())


def counted(number: int, one: str) -> str:
    """The number with its noun."""
    return f"{number} {one}" if number == 1 else f"{number} {one}s"


def _distinct(planes: Planes) -> list[int]:
    """The first of each plane."""
    scale = float(abs(planes[:, 3]).max()) or 1.0
    pairs = KDTree(planes / [1, 1, 1, scale]).query_pairs(SAME_PLANE, p=np.inf, output_type="ndarray")
    later = set(pairs.max(axis=1).tolist()) if len(pairs) else set()
    return [k for k in range(len(planes)) if k not in later]


def _enclosed(planes: Planes) -> Intersection:
    try:
        return intersection("the design", planes)
    except MeshError as error:
        open_at = _open_directions(planes)
        if not open_at:
            raise
        raise MeshError(
            f"the design is open {' and '.join(open_at)}: its {counted(len(planes), 'facet')} enclose no solid"
        ) from error


def _open_directions(planes: Planes) -> list[str]:
    """Where a point can leave all half-spaces behind: those ways u that have n.u <= 0 for each normal n."""
    axes = (("above", (0, 0, 1)), ("below", (0, 0, -1)), ("sideways", (1, 0, 0)), ("sideways", (-1, 0, 0)),
            ("sideways", (0, 1, 0)), ("sideways", (0, -1, 0)))  # fmt: skip
    straight = [said for said, way in axes if (planes[:, :3] @ way).max() <= SAME_PLANE]
    return list(dict.fromkeys(straight)) or ["askew"] * any(_leaves(planes, way) for _, way in axes)


def _leaves(planes: Planes, axis: tuple[int, int, int]) -> bool:
    """Whether there is such a way with a part along the axis."""
    answer = linprog(
        -np.array(axis), A_ub=planes[:, :3], b_ub=np.zeros(len(planes)), bounds=[(-1, 1)] * 3, method="highs"
    )
    return bool(answer.status == 0 and -answer.fun > 1e-7)
