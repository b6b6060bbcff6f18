"""A cutter's design cut anew: its tiers, names and notes kept, with the angles and distances that result."""

from __future__ import annotations

from dataclasses import replace

from culet.geometry.designs.design import Design, Plane, Tier
from culet.geometry.designs.grouping import tier_of
from culet.geometry.designs.solid import Solid
from culet.geometry.recut import TABLE, recut_planes, said_of
from culet.scene.recut import Recut


def recut_design(design: Design, recut: Recut) -> Design:
    """The design; each facet once. MeshError names the proportion that cannot be, or says where the design is open."""
    if not recut.changes:
        return design
    solid = Solid(design)
    planes, gone = recut_planes("the design", solid.cut.planes, recut)
    listed: list[Plane] = [(x, y, z, d) for x, y, z, d in planes.tolist()]
    tiers: list[Tier] = []
    for number, tier in enumerate(design.tiers, 1):
        own = [k for k, (of, _) in enumerate(solid.facets) if of == number]
        if own:
            names = [solid.facets[k][1].name for k in own]
            tiers.append(tier_of([listed[k] for k in own], names, design.wheel, tier.notes))
    tiers += [tier_of([plane], [TABLE], design.wheel) for plane in listed[len(solid.facets) :]]
    return replace(design, tiers=tuple(tiers), findings=(*design.findings, *said_of(gone)))
