"""Stones cut anew: tangent ratios keep every meet, index and the girdle; table and girdle are as they are asked for."""

from __future__ import annotations

import numpy as np
import pytest

from culet.errors import MeshError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.cutting.recut import recut_shape
from culet.geometry.cutting.recut_design import recut_design
from culet.geometry.designs.measures import proportions_of
from culet.geometry.designs.of_shape import design_of
from culet.geometry.designs.proportions import Proportions
from culet.geometry.designs.solid import Solid, shape_of_design
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.scene.cuts import EmeraldCut, HeartCut
from culet.scene.recut import Recut
from culet.scene.stone import StoneSettings
from geometry.designs.files import NAMES, design

BOX = np.array([[x, y, z, 1] for x, y, z in [*np.eye(3), *-np.eye(3)]])


def measured(shape: Shape) -> Proportions:
    return proportions_of(Solid(design_of(shape)))


@pytest.mark.parametrize("name", NAMES)
def test_a_tangent_ratio_keeps_every_meet_and_index_of_any_design(name: str) -> None:
    before = Solid(design(name))
    ratios = Recut(crown_ratio=1.15, pavilion_ratio=0.9)
    after = Solid(recut_design(design(name), ratios))
    # The same corners of the same facets, so the same meets; where two are one but for rounding, either may come first.
    assert [len(polygon) for polygon in after.cut.polygons] == [len(polygon) for polygon in before.cut.polygons]
    for (_, old), (_, new) in zip(before.facets, after.facets, strict=True):
        assert old.name == new.name
        slope = np.hypot(*old.plane[:2]), np.hypot(*new.plane[:2])
        if min(slope) > 1e-9:
            (x, y), (u, v) = old.plane[:2], new.plane[:2]
            assert x * v - y * u == pytest.approx(0, abs=1e-12)  # the same azimuth
        if abs(old.plane[2]) > 1e-9:
            wanted = 1.15 if old.plane[2] > 0 else 0.9
            assert slope[1] * abs(old.plane[2]) == pytest.approx(wanted * slope[0] * abs(new.plane[2]), rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_crown_and_pavilion_are_as_much_higher_as_they_are_steeper(name: str) -> None:
    was = proportions_of(Solid(design(name)))
    now = measured(recut_shape(shape_of_design(design(name)), Recut(crown_ratio=1.2, pavilion_ratio=0.85)))
    if was.girdle_percent is None or was.crown_percent is None or was.pavilion_percent is None:
        assert now.height != pytest.approx(was.height, rel=0.01)
        return
    if name != "13_chiral_negative_wheel":  # its girdle is wavy: what stays is its thinnest place
        assert now.girdle_percent == pytest.approx(was.girdle_percent, rel=1e-6)
        assert now.crown_percent == pytest.approx(1.2 * was.crown_percent, rel=1e-6)
    assert now.pavilion_percent == pytest.approx(0.85 * was.pavilion_percent, rel=1e-6)


@pytest.mark.parametrize("name", ["02_round_tolkowsky", "04_emerald_1.4", "12_marquise_2"])
def test_table_and_girdle_are_those_that_were_asked_for(name: str) -> None:
    shape = shape_of_design(design(name))
    now = measured(recut_shape(shape, Recut(table_percent=50, girdle_percent=5.5)))
    assert now.table_percent == pytest.approx(50, abs=1e-5)  # measured 1.2e-6, by the linear programme
    assert now.girdle_percent == pytest.approx(5.5, abs=1e-5)  # corners within 1e-4 are one
    assert now.pavilion_percent == pytest.approx(measured(shape).pavilion_percent, abs=1e-9)


def test_a_rose_is_given_a_table_with_a_name_of_its_own() -> None:
    rose = shape_of_design(design("08_rose_flat_base"))
    cut = recut_shape(rose, Recut(table_percent=50))
    assert measured(cut).table_percent == pytest.approx(50, abs=1e-5)
    assert cut.names[-1] == (6, "T")
    assert cut.findings[-1] == "Cut anew, 6 of its facets bound nothing."


def test_a_refusal_names_the_proportion_and_says_how_far_it_may_go() -> None:
    wavy = shape_of_design(design("13_chiral_negative_wheel"))
    with pytest.raises(
        MeshError, match=r"expected more than 3\.117, where its thinnest place is nothing; got 2"
    ) as refused:
        recut_shape(wavy, Recut(girdle_percent=2))
    assert refused.value.field == "girdle_percent"
    with pytest.raises(MeshError, match="expected a crown that closes above a table; got 50") as refused:
        recut_shape(shape_from_half_spaces("box", BOX), Recut(table_percent=50))
    assert refused.value.field == "table_percent"


def test_crown_and_pavilion_that_meet_at_several_heights_keep_no_meets_alone() -> None:
    """Two wedges, one across the other, as of a tetrahedron: their edges are not level."""
    planes = np.array([[1, 1, 0, 1], [-1, 1, 0, 1], [0, -1, 1, 1], [0, -1, -1, 1]], np.float64)
    askew = shape_from_half_spaces("tetrahedron", planes)
    with pytest.raises(MeshError, match="expected 1, since crown and pavilion meet at several heights") as refused:
        recut_shape(askew, Recut(pavilion_ratio=1.1))
    assert refused.value.field == "pavilion_ratio"


def test_a_girdle_that_there_is_not_is_refused() -> None:
    with pytest.raises(MeshError, match="girdle_percent: the stone has no girdle"):
        recut_shape(shape_of_design(design("11_briolette")), Recut(girdle_percent=3))


def test_a_stone_of_a_scene_is_cut_anew_and_a_refusal_names_its_place() -> None:
    shape = shape_of_design(design("02_round_tolkowsky"))
    stone = StoneSettings(mesh="m", recut=Recut(pavilion_ratio=1.1))
    assert measured(shape_of(stone, {"m": shape})).pavilion_percent == pytest.approx(1.1 * 43.083, rel=1e-4)
    emerald = StoneSettings(cut=EmeraldCut(), recut=Recut(table_percent=40))
    assert measured(shape_of(emerald, {})).table_percent == pytest.approx(40, abs=1e-5)
    wavy = shape_of_design(design("13_chiral_negative_wheel"))
    with pytest.raises(MeshError) as refused:
        shape_of(StoneSettings(mesh="m", recut=Recut(girdle_percent=0.001)), {"m": wavy}, "stones.3")
    assert refused.value.field == "stones.3.recut.girdle_percent"


def test_a_heart_is_not_cut_anew_and_nothing_said_changes_nothing() -> None:
    heart = shape_of_cut(HeartCut())
    assert recut_shape(heart, Recut()) is heart
    with pytest.raises(MeshError, match="expected a convex stone to cut anew"):
        recut_shape(heart, Recut(crown_ratio=1.1))
