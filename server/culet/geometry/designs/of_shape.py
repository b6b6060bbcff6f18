"""A convex stone as a design: its facets on an index wheel, by their tiers and names."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.errors import MeshError
from culet.geometry.designs.design import LEVEL, Design, PlaneRow, Tier, Wheel
from culet.geometry.designs.grouping import tier_of
from culet.geometry.shape import FacetName, Shape

WHEEL = Wheel(96)
"""The usual one."""
SAME_ANGLE = 1e-6
"""Of normals and distances (R) of facets without names that are one tier: about what files in single precision have."""


def design_of(shape: Shape, headings: Sequence[str] = ()) -> Design:
    """The design, its index 0 away from a viewer at +z and its unit R, as a cutter's file would be read.

    Tiers and names are the shape's; facets without any are gathered by angle and distance, from the table down.
    MeshError if the stone is not convex.
    """
    if not shape.convex:
        raise MeshError(f"{shape.name}: expected a convex stone, as designs are; got one that is not")
    planes = [_turned(plane) for plane in shape.planes]
    names = shape.names or _by_angle(planes)
    tiers: dict[int, list[int]] = {}
    for facet, name in enumerate(names):
        tiers.setdefault(name.tier, []).append(facet)
    return Design(
        "shape",
        WHEEL,
        tuple(_tier([(planes[k], names[k].name) for k in tiers[number]]) for number in sorted(tiers)),
        headings=tuple(headings) or (shape.name,),
    )


def _turned(plane: NDArray[np.float64]) -> PlaneRow:
    """In a cutter's frame; what is level or upright but for rounding is so exactly."""
    x, y, z, distance = (float(component) for component in plane)
    normal = np.array([x, -z, y])
    if np.hypot(x, z) < LEVEL:
        normal = np.array([0.0, 0.0, np.copysign(1.0, y)])
    elif abs(y) < LEVEL:
        normal[2] = 0.0
    return float(normal[0]), float(normal[1]), float(normal[2]), distance


def _tier(facets: list[tuple[PlaneRow, str]]) -> Tier:
    tier = tier_of([plane for plane, _ in facets], [name for _, name in facets], WHEEL)
    order = sorted(range(len(facets)), key=lambda k: tier.facets[k].index % abs(WHEEL.teeth))
    return tier_of([facets[k][0] for k in order], [facets[k][1] for k in order], WHEEL)


def _by_angle(planes: list[PlaneRow]) -> tuple[FacetName, ...]:
    order = sorted(range(len(planes)), key=lambda k: (-planes[k][2], planes[k][3]))
    tiers = [0] * len(planes)
    number, last = 0, None
    for k in order:
        here = np.array(planes[k][2:])
        if last is None or np.abs(here - last).max() > SAME_ANGLE:
            number += 1
        last = here
        tiers[k] = number
    return tuple(FacetName(tier, "") for tier in tiers)
