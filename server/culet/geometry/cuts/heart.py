"""The heart: two lobes, each a brilliant about one culet, cut where they meet. The cleft makes it not convex."""

from __future__ import annotations

import numpy as np

from culet.geometry.assembly import assemble
from culet.geometry.cuts.brilliants import brilliant_on
from culet.geometry.cuts.facets import turned_up
from culet.geometry.cuts.outlines import lobe
from culet.geometry.half_spaces import intersection
from culet.geometry.polygons import fan
from culet.geometry.shape import FacetName, Shape
from culet.scene.cuts import HeartCut

_LEAST_STAR = 0.4
"""Of the way from where stars would be level: those at a lobe's pointed end could not slope otherwise."""


def heart(cut: HeartCut) -> Shape:
    """Its facets are those of both lobes; the two tables are one. MeshError if a lobe is no brilliant."""
    facets = brilliant_on(lobe(cut.length_to_width, cut.lobe_percent / 100), cut, least_star=_LEAST_STAR)
    whole = facets.intersection()
    half = turned_up(intersection(cut.name, np.vstack([whole.planes, [-1, 0, 0, 0]])))
    seam = half.polygons[-1]
    corners = half.vertices.copy()
    corners[seam, 0] = 0  # both lobes' to the bit
    others = np.setdiff1d(np.arange(len(corners)), seam)
    mirrored = np.arange(len(corners))
    mirrored[others] = len(corners) + np.arange(len(others))
    right = [polygon for polygon in half.polygons[:-1] if polygon]
    used = [k for k, polygon in enumerate(half.polygons[:-1]) if polygon]
    left = [mirrored[polygon[::-1]].tolist() for polygon in right]
    triangles, facet = fan([*right, *left])
    facet[facet == len(right)] = 0  # the table
    facet[facet > len(right)] -= 1
    planes, names = half.planes[used], _renumbered([facets.names()[k] for k in used])
    more = planes[1:] * [-1, 1, 1, 1]
    return assemble(
        cut.name, np.vstack([corners, corners[others] * [-1, 1, 1]]), triangles, facet, np.vstack([planes, more]),
        convex=False, names=[*names, *names[1:]],
    )  # fmt: skip


def _renumbered(names: list[FacetName]) -> list[FacetName]:
    """Without the tiers of facets that the other lobe has cut away."""
    numbers = {tier: number for number, tier in enumerate(sorted({name.tier for name in names}), 1)}
    return [FacetName(numbers[name.tier], name.name) for name in names]
