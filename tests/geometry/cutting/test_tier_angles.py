"""What is told of tiers: at each end of a reach all meets are kept, and a little beyond they are not."""

from __future__ import annotations

import pytest

from culet.errors import MeshError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.cutting import meets
from culet.geometry.cutting.recut import recut_shape
from culet.geometry.cutting.tier_angles import tiers_of
from culet.geometry.cutting.tiers import TierAngle
from culet.geometry.designs.shipped import SHIPPED, shipped_shape
from culet.geometry.designs.solid import shape_of_design
from culet.geometry.shape import Shape
from culet.scene.cuts import BrilliantCut, HeartCut
from culet.scene.recut import Recut
from geometry.designs.files import design


def tier_of(shape: Shape, number: int, recut: Recut | None = None, *, reach: bool = False) -> TierAngle:
    cut = shape if recut is None else recut_shape(shape, recut)
    tiers = tiers_of(cut, shape, recut, number if reach else None).tiers
    return next(each for each in tiers if each.tier == number)


@pytest.mark.parametrize(("name", "number"), [("01_srb_from_angles", 2), ("01_srb_from_angles", 3)])
def test_within_its_reach_a_tier_keeps_all_meets_and_beyond_it_does_not(name: str, number: int) -> None:
    shape = shape_of_design(design(name))
    usual, near = tier_of(shape, number), tier_of(shape, number, reach=True)
    assert usual.least <= near.least < near.degrees < near.most <= usual.most + 0.011
    for end, farthest, beyond in ((near.least, usual.least, -0.06), (near.most, usual.most, 0.06)):
        recut_shape(shape, Recut(angles={number: end}))  # which is known to 0.03 degrees
        refusal = "keep all meets" if abs(end - farthest) > 0.06 else "within 20 degrees"
        with pytest.raises(MeshError, match=refusal):
            recut_shape(shape, Recut(angles={number: end + beyond}))


def test_ends_that_take_too_long_to_find_are_told_as_if_no_meet_were_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each for itself: that the lower one takes long leaves the upper one as it is."""
    shape = shape_of_cut(BrilliantCut())
    usual, near = tier_of(shape, 7), tier_of(shape, 7, reach=True)
    monkeypatch.setattr(meets, "MOST_WORK", 3e7)
    one_sided = tier_of(shape, 7, reach=True)
    assert one_sided.most == near.most, "the upper end takes 1.3e7, the lower one 2.1e7"
    assert one_sided.least <= near.least
    monkeypatch.setattr(meets, "MOST_WORK", 1)
    unknown = tier_of(shape, 7, reach=True)
    assert (unknown.least, unknown.most) == pytest.approx((usual.least, usual.most), abs=0.011)


def test_a_reach_is_less_or_more_where_another_tier_was_turned() -> None:
    """The brilliant's mains reach the culet before the lower halves do: steeper halves leave the mains more room."""
    shape = shape_of_cut(BrilliantCut())
    halves = next(each for each in tiers_of(shape, shape, None).tiers if each.names == ("lower half",))
    mains = next(each for each in tiers_of(shape, shape, None).tiers if each.names == ("main",))
    before = tier_of(shape, mains.tier, reach=True)
    after = tier_of(shape, mains.tier, Recut(angles={halves.tier: halves.degrees + 1}), reach=True)
    assert after.most > before.most + 0.5
    assert after.independent


def test_ends_are_counted_from_the_stretched_stone() -> None:
    shape = shape_of_cut(BrilliantCut())
    plain, stretched = tier_of(shape, 7), tier_of(shape, 7, Recut(pavilion_ratio=1.1, angles={4: 41}))
    assert stretched.degrees > plain.degrees + 1
    assert stretched.most - stretched.degrees == pytest.approx(plain.most - plain.degrees, abs=0.02)


def test_stones_without_tiers_are_refused() -> None:
    heart = shape_of_cut(HeartCut())
    with pytest.raises(MeshError, match="expected a convex stone"):
        tiers_of(heart, heart, None)


def test_every_shipped_design_is_whole_and_has_tiers_to_turn() -> None:
    for name in SHIPPED:
        shape = shipped_shape(name)
        assert shape.convex
        assert len([tier for tier in tiers_of(shape, shape, None).tiers if tier.independent]) >= 3
