"""Stones as designs: read back from what is written, they are the same stones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import KDTree

from culet.errors import MeshError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.designs.asc import read_asc
from culet.geometry.designs.asc_writer import asc_of
from culet.geometry.designs.diagram import diagram_of
from culet.geometry.designs.of_shape import design_of
from culet.geometry.designs.solid import Solid, shape_of_design
from culet.scene.cuts import CUTS, HeartCut, PearCut
from shared.stones import step_cut


@pytest.mark.parametrize("name", [name for name in CUTS if name != "heart"])
def test_a_cut_written_as_a_cutters_file_is_the_same_stone_when_read(name: str) -> None:
    shape = shape_of_cut(CUTS[name]())
    _, data, _ = asc_of(design_of(shape))
    again = shape_of_design(read_asc(data))
    assert KDTree(again.planes).query(shape.planes, p=np.inf)[0].max() < 1e-8  # measured 3e-15
    assert len(again.planes) == len(shape.planes)
    said = {facet.name.replace(" ", "_") for facet in shape.names}
    assert {facet.name for facet in again.names} == said


def test_tiers_keep_their_names_and_lie_in_the_order_of_the_wheel() -> None:
    design = design_of(shape_of_cut(PearCut()), ["Pear"])
    assert design.title == "Pear"
    assert [tier.name for tier in design.tiers][:2] == ["table", "star"]
    mains = next(tier for tier in design.tiers if tier.name == "kite" and len(tier.facets) == 2)
    assert [facet.index for facet in mains.facets] == sorted(facet.index for facet in mains.facets)
    drawing = diagram_of(Solid(design))
    assert "Pear" in drawing
    assert "style" not in drawing  # pages with a policy forbid it, and faces would be black
    assert drawing.count('fill="#fff"') > len(design.planes())


def test_facets_without_names_are_tiers_by_angle_and_distance() -> None:
    """A step cut of 4 sides: table, crown, girdle, pavilion, and its culet if it has one."""
    shape = step_cut()
    design = design_of(shape)
    assert sum(len(tier.facets) for tier in design.tiers) == len(shape.planes)
    for tier in design.tiers:
        z, distance = np.array([facet.plane[2:] for facet in tier.facets]).T
        assert np.ptp(z) < 1e-6
        assert np.ptp(distance) < 1e-6


def test_a_stone_that_is_not_convex_is_no_design() -> None:
    with pytest.raises(MeshError, match="heart: expected a convex stone"):
        design_of(shape_of_cut(HeartCut()))
