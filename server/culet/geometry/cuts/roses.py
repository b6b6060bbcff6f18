"""Small cuts of flat rings: the Dutch rose and the single cut."""

from __future__ import annotations

import math

from culet.geometry.cuts.facets import Facets, Points, at, turned
from culet.scene.cuts import RoseCut, SingleCut


def rose(cut: RoseCut) -> Facets:
    """An apex, six corners of a ring, twelve of the girdle: triangles between them, and a flat base."""
    girdle = 2 * cut.girdle_percent / 100
    height = 2 * cut.height_percent / 100
    apex = at((0, 0), girdle + height)
    ring_height = girdle + height * cut.ring_height_percent / 100
    ring = [turned(cut.ring_percent / 100, k * math.pi / 3, ring_height) for k in range(6)]
    high, low = ([turned(1, k * math.pi / 6, z) for k in range(12)] for z in (girdle, 0.0))
    facets = Facets(cut.name)
    for k in range(6):
        after = (k + 1) % 6
        facets.add("star", apex, ring[k], ring[after])
        facets.add("crown", ring[k], high[2 * k + 1], ring[after])
        facets.add("tooth", ring[k], high[2 * k], high[2 * k + 1])
        facets.add("tooth", ring[k], high[2 * k - 1], high[2 * k])
    for k in range(12):
        after = (k + 1) % 12
        facets.add("girdle", low[k], low[after], high[after], high[k])
    facets.add("base", *reversed(low))
    return facets


def single(cut: SingleCut) -> Facets:
    """Eight facets from an octagon to the table, eight to the culet; angles are of the facets, from side to side."""
    table, half_girdle = cut.table_percent / 100, cut.girdle_percent / 100
    height = (1 - table) * math.tan(math.radians(cut.crown_degrees))
    depth = math.tan(math.radians(cut.pavilion_degrees))
    radius = 1 / math.cos(math.pi / 8)

    def ring(scale: float, z: float) -> list[Points]:
        return [turned(scale * radius, (2 * k + 1) * math.pi / 8, z) for k in range(8)]

    top, high, low = ring(table, half_girdle + height), ring(1, half_girdle), ring(1, -half_girdle)
    culet = at((0, 0), -half_girdle - depth)
    facets = Facets(cut.name)
    facets.add("table", *top)
    for k in range(8):
        facets.add("crown", high[k - 1], high[k], top[k], top[k - 1])
        facets.add("girdle", low[k - 1], low[k], high[k], high[k - 1])
        facets.add("main", low[k], low[k - 1], culet)
    return facets
