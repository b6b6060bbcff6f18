"""Angles changed with all meets kept: every corner has the facets that it had, and nobody's angle moves in vain."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import culet.geometry.cutting.meets
from culet.errors import InputError, MeshError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.cutting.meets import angle_of_tiers, independent_tiers
from culet.geometry.cutting.recut import OF_A_SHAPE, recut_shape
from culet.geometry.cutting.recut_design import angles_of, angles_that_followed, recut_design
from culet.geometry.designs.measures import DesignOutline, outline_of, proportions_of
from culet.geometry.designs.solid import Solid, shape_of_design
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.scene.cuts import BrilliantCut
from culet.scene.recut import Recut
from geometry.designs.files import design

BOX = np.array([[x, y, z, 1] for x, y, z in [*np.eye(3), *-np.eye(3)]])


def meets(outline: DesignOutline) -> set[frozenset[int]]:
    """Of each corner its facets."""
    found: list[set[int]] = [set() for _ in outline.corners]
    for facet, face in enumerate(outline.faces):
        for corner in face:
            found[corner].add(facet)
    return {frozenset(facets) for facets in found if facets}


def angles(solid: Solid) -> dict[int, float]:
    return angle_of_tiers(solid.cut.planes, [number for number, _ in solid.facets])


@pytest.mark.parametrize("name", ["04_emerald_1.4", "06_oval_1.4", "08_rose_flat_base", "13_chiral_negative_wheel"])
def test_every_meet_of_any_design_is_kept(name: str) -> None:
    before = Solid(design(name))
    tier, degrees = next(iter(angles(before).items()))
    after = Solid(recut_design(design(name), Recut(angles={tier: degrees + 0.4})))
    assert angles(after)[tier] == pytest.approx(degrees + 0.4, abs=1e-9)
    assert meets(outline_of(after.cut)) == meets(outline_of(before.cut))
    upright = before.cut.planes[:, 2] == 0
    assert np.array_equal(after.cut.planes[upright], before.cut.planes[upright]), "the girdle's outline stays"


@pytest.mark.parametrize("name", ["01_srb_from_angles", "05_princess", "09_old_european"])
def test_other_angles_stay_where_distances_alone_can_follow(name: str) -> None:
    before = Solid(design(name))
    for tier, degrees in list(angles(before).items())[::2]:
        after = angles(Solid(recut_design(design(name), Recut(angles={tier: degrees - 0.3}))))
        assert after == pytest.approx(angles(before) | {tier: degrees - 0.3}, abs=1e-9)


def test_the_distances_are_those_that_a_cutter_finds_from_meet_to_meet() -> None:
    """The standard round brilliant by its instructions: mains through the girdle's corners, then each facet through
    the meet of those before it. The meets of `made/01` are the same construction at other angles."""
    main, upper, kite, star = 41.0, 33.5, 27.0, 15.0
    cut = Solid(recut_design(design("01_srb_from_angles"), Recut(angles={3: main, 4: upper, 5: kite, 6: star})))
    azimuth = math.radians(360 * 3 / 96)
    half = math.radians(360 * 6 / 96)
    plane = {tier: next(facet.plane for number, facet in cut.facets if number == tier) for tier in range(1, 8)}
    corners = outline_of(cut.cut).corners
    level = corners[abs(np.hypot(corners[:, 0], corners[:, 1]) - plane[1][3] / math.cos(azimuth)) < 1e-6]
    reach, top, bottom = plane[1][3] / math.cos(azimuth), level[:, 2].max(), level[:, 2].min()

    def through(degrees: float, out: float, height: float) -> float:
        """Distance of a facet of the slope through a point so far out along its azimuth, and so high."""
        return math.sin(math.radians(degrees)) * out + math.cos(math.radians(degrees)) * height

    near = 3e-7  # the file has 8 decimals, so that its meets are 6e-8 wide
    assert plane[3][3] == pytest.approx(through(main, reach, -bottom), abs=near)
    assert plane[4][3] == pytest.approx(through(upper, plane[1][3], top), abs=near)
    assert plane[5][3] == pytest.approx(through(kite, reach, top), abs=near)
    # The star's tip: where two upper halves meet two kites, on the azimuth between these.
    slopes = math.tan(math.radians(upper)) * math.cos(half - azimuth), math.tan(math.radians(kite)) * math.cos(half)
    heights = [plane[4][3] / math.cos(math.radians(upper)), plane[5][3] / math.cos(math.radians(kite))]
    out = (heights[0] - heights[1]) / (slopes[0] - slopes[1])
    assert plane[6][3] == pytest.approx(through(star, out, heights[0] - slopes[0] * out), abs=near)


def test_the_girdle_keeps_its_height_and_no_angle_is_no_change() -> None:
    given = design("12_marquise_2")
    was = proportions_of(Solid(given))
    now = proportions_of(Solid(recut_design(given, Recut(angles={22: 38.8}))))
    assert now.girdle_percent == pytest.approx(was.girdle_percent, abs=1e-4)
    assert (now.width, now.length) == pytest.approx((was.width, was.length), abs=1e-9)
    own = angles(Solid(given))
    same = Solid(recut_design(given, Recut(angles=own)))
    assert abs(same.cut.planes - Solid(given).cut.planes).max() < 1e-9


def test_what_followed_is_told_and_a_heading_says_what_was_done() -> None:
    given = design("04_emerald_1.4")
    recut = Recut(pavilion_ratio=1.01, angles={14: 57})
    cut = recut_design(given, recut)
    followed = angles_that_followed(given, cut, recut)
    assert len(followed) == 8  # the corner of a step cut's keel is met by all tiers of the pavilion
    assert followed[0].startswith("Tier 15 (pavilion_1_corner) followed from ")
    assert cut.headings[-1] == "Cut anew: pavilion x 1.01, tier 14 at 57"
    assert len(cut.headings) <= 4
    assert angles_that_followed(given, recut_design(given, Recut()), Recut()) == []


def test_a_shape_is_cut_anew_as_its_design_is() -> None:
    given = design("02_round_tolkowsky")
    recut = Recut(crown_ratio=1.05, angles={7: 41, 4: 42}, table_percent=55)
    shape = recut_shape(shape_of_design(given), recut)
    other = shape_of_design(recut_design(given, recut))
    assert shape.planes == pytest.approx(other.planes, abs=1e-9)
    tiers = [name.tier for name in shape.names]
    found = angle_of_tiers(shape.planes @ OF_A_SHAPE.T, tiers)
    assert (found[7], found[4]) == pytest.approx((41, 42), abs=1e-9)


def test_a_refusal_says_how_far_the_angle_may_go() -> None:
    brilliant = shape_of_cut(BrilliantCut())
    with pytest.raises(MeshError, match=r"as far as tier 3 at 4\d\.\d\d; got tier 3 at 45\.00") as refused:
        recut_design(design("01_srb_from_angles"), Recut(angles={3: 45}))  # the lower halves would reach the culet
    assert refused.value.field == "angles"
    for recut, said in (
        ({99: 40}, "expected a tier of 1 to 7, got 99"),
        ({1: 40}, "expected a tier of sloping facets; tier 1 is level or upright"),
        ({3: 80}, r"expected tier 3 within 20 degrees of 34\.50, got 80"),
    ):
        with pytest.raises(MeshError, match=said) as refused:
            recut_shape(brilliant, Recut(angles=recut))
        assert refused.value.field == "angles"
    with pytest.raises(MeshError, match="expected a stone whose facets have tiers"):
        recut_shape(shape_from_half_spaces("box", BOX), Recut(angles={1: 40}))


def test_tiers_that_are_free_of_each_other_can_all_be_changed_at_once() -> None:
    """Of a brilliant all, as its proportions say; of an oval, whose facets are of many angles, half."""
    for name, free in (("01_srb_from_angles", [2, 3, 4, 5, 6]), ("06_oval_1.4", [2, 3, 9, 10, 13, 17, 18, 21])):
        given = Solid(design(name))
        own = angles(given)
        assert len(independent_tiers(name, given.cut.planes, [number for number, _ in given.facets])) == len(free)
        wanted = {tier: own[tier] + 0.1 * (-1) ** tier for tier in free}
        found = angles(Solid(recut_design(design(name), Recut(angles=wanted))))
        assert {tier: found[tier] for tier in free} == pytest.approx(wanted, abs=1e-9)


def test_tiers_are_named_by_number_or_by_name() -> None:
    given = design("01_srb_from_angles")  # its tiers are called G, 1, 2, A, B, C and T
    assert angles_of(given, ["A=33", " 3 = 41.2"]) == {4: 33, 3: 41.2}
    for text, said in (("Z=3", r"of 1 \(G\), 2 \(1\)"), ("A", "expected TIER=DEGREES"), ("A=x", "degrees after A=")):
        with pytest.raises(InputError, match=said):
            angles_of(given, [text])
    with pytest.raises(InputError, match="expected each tier once, got A again"):
        angles_of(given, ["4=33", "A=34"])


def test_what_takes_too_long_is_given_up_with_how_far_it_came(monkeypatch: pytest.MonkeyPatch) -> None:
    """With less work than it takes; the whole is 3 s of a processor."""
    monkeypatch.setattr(culet.geometry.cutting.meets, "MOST_WORK", 3e7)
    with pytest.raises(
        MeshError, match=r"expected a smaller change of a stone of \d+ facets and \d+ angles"
    ) as refused:
        recut_design(design("06_oval_1.4"), Recut(angles={2: 23}))
    assert refused.value.field == "angles"
    said = re.search(r"followed as far as tier 2 at (\S+) in the time for it; got tier 2 at 23\.00", str(refused.value))
    assert said
    own = angles(Solid(design("06_oval_1.4")))[2]
    assert 0 < abs(float(said[1]) - own) < abs(23 - own)


def test_what_followed_is_told_of_the_right_tiers_where_one_repeats_another() -> None:
    """The repeated one is cut once, so that all behind it have other numbers in what is made."""
    given = design("04_emerald_1.4")
    repeated = replace(given, tiers=(*given.tiers[:3], given.tiers[2], *given.tiers[3:]))
    recut = Recut(angles={15: 57})
    followed = angles_that_followed(repeated, recut_design(repeated, recut), recut)
    assert len(followed) == 8
    assert followed[0].startswith("Tier 16 (pavilion_1_corner) followed from ")
    same = Recut(pavilion_ratio=1.01, angles={15: 57})
    assert len(angles_that_followed(repeated, recut_design(repeated, same), same)) == 8
