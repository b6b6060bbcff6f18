"""The search of tangent ratios: it finds better designs than it was given, within its means, and the front of all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from culet.batch.angle_search import LEAST_REACH, AngleSearch, free_angles, turn_tiers
from culet.batch.search import BRIGHTNESS, FIRE, Candidate, Search
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.recut import OF_A_SHAPE, recut_shape
from culet.geometry.shape import FacetName, Shape
from culet.grading.grades import grade
from culet.grading.number import Number
from culet.grading.optics import StoneOptics, optics_of
from culet.grading.rules import Rules
from culet.grading.sums import LightSums
from culet.rendering.device import open_device
from culet.scene.cuts import BrilliantCut, SingleCut
from culet.scene.recut import Recut
from culet.scene.stone import StoneSettings

DIAMOND = optics_of(StoneSettings(), 3.25)


def search(shape: Shape, evaluations: int, optics: StoneOptics = DIAMOND) -> Search:
    return Search(LightSums(open_device()), shape, optics, Rules(), {"iso": 1, "fire": 1}, evaluations)


def graded(shape: Shape) -> Candidate:
    """As it is, for ISO and fire."""
    grades = next(grade(LightSums(open_device()), shape, DIAMOND, Rules()))
    return Candidate(1, 1, {"iso": grades.iso, "fire": grades.fire}, grades.iso.value + grades.fire.value)


def test_a_flat_pavilion_is_found_to_be_too_flat() -> None:
    """At 36 degrees diamond leaks: Tolkowsky's 40.75 is a ratio of 1.186."""
    flat = shape_of_cut(SingleCut(pavilion_degrees=36))
    found = search(flat, 16)
    found.run((0.8, 1.25), (0.9, 1.3))
    given, best = found.candidates[0], found.best()
    assert len(found.candidates) <= 17
    assert best.total > given.total + 10
    assert 1.1 < best.pavilion_ratio < 1.3
    front = found.front()
    values = [(each.grades[BRIGHTNESS].value, each.grades[FIRE].value) for each in front]
    assert values == sorted(values, key=lambda pair: (-pair[0], pair[1])), "brighter is less fiery"
    for each in found.candidates:
        bright, fiery = each.grades[BRIGHTNESS].value, each.grades[FIRE].value
        assert any(a >= bright and b >= fiery for a, b in values)


def test_a_design_has_in_the_search_the_grades_that_it_has_alone() -> None:
    shape = shape_of_cut(SingleCut())
    found = search(shape, 3)
    found.run((0.99, 1.01), (0.99, 1.01))
    alone = next(grade(LightSums(open_device()), shape, DIAMOND, Rules()))
    assert found.candidates[0].grades["iso"] == alone.iso
    assert found.candidates[0].total == pytest.approx(alone.iso.value + alone.fire.value)


@pytest.mark.validation
def test_angles_of_single_tiers_find_what_ratios_cannot() -> None:
    """Lower halves as steep as the mains are too flat: no ratio changes the one without the other."""
    shape = shape_of_cut(BrilliantCut(lower_half_percent=40))
    found = search(shape, 1)
    found.candidates.append(found_by_ratios := graded(shape))
    angles = AngleSearch(LightSums(open_device()), shape, DIAMOND, Rules(), {"iso": 1, "fire": 1})
    turn_tiers(found, angles, 3, 10)
    assert len(found.candidates) <= 10
    best = found.best()
    assert best.total > found_by_ratios.total + 0.5
    again = recut_shape(shape, Recut(angles=dict(best.angles)))
    assert graded(again).total == pytest.approx(best.total, abs=1e-9)
    nameless = AngleSearch(LightSums(open_device()), replace(shape, names=()), DIAMOND, Rules(), {})
    assert nameless.run(found_by_ratios, lambda each: each.total, 3, 10) == []


def test_angles_are_searched_within_the_smallest_reach_too() -> None:
    """Smaller than twice the step that is the last otherwise."""
    shape = shape_of_cut(SingleCut())
    angles = AngleSearch(LightSums(open_device()), shape, DIAMOND, Rules(), {"iso": 1})
    start = Candidate(1, 1, {}, 0)
    for reach in (0.01, LEAST_REACH):
        found = angles.run(start, lambda each: each.total, reach, 2)
        own = free_angles(shape)
        assert len(found) == 2
        assert all(each.angles == pytest.approx(own, abs=1.001 * reach) for each in found)
    assert angles.run(start, lambda each: each.total, 0.9 * LEAST_REACH, 2) == []


def test_a_tier_that_is_nearly_level_or_of_two_slopes_is_not_searched() -> None:
    """A pyramid below a girdle, and above it one of 0.001 degrees, or one whose sides differ by less than is told
    apart, one from the other, on both sides of the first."""
    around = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]], np.float64)

    def shape(slopes: list[float]) -> Shape:
        sides = [(*around[k], 0.0, 1.0) for k in range(4)]
        above = [(*np.sin(slope) * around[k], np.cos(slope), 1.1) for k, slope in enumerate(slopes)]
        below = [(*np.sqrt(0.5) * around[k], -np.sqrt(0.5), 1.0) for k in range(4)]
        planes = np.array([*sides, *above, *below]) @ OF_A_SHAPE
        names = [FacetName(1 + k // 4, "") for k in range(12)]
        return replace(shape_from_half_spaces("pyramids", planes), names=tuple(names))

    assert set(free_angles(shape([1.2] * 4))) == {2, 3}
    for slopes in ([np.radians(0.001)] * 4, [1.2, 1.2 + 9e-7, 1.2 - 9e-7, 1.2]):
        assert set(free_angles(shape(slopes))) == {3}


def test_the_front_has_each_design_once_and_none_that_another_beats() -> None:
    found = search(shape_of_cut(SingleCut()), 10)
    for iso, fire in ((80, 40), (85, 30), (79, 39), (70, 60), (85, 29), (80, 40)):
        numbers = {"iso": Number(iso, 0.1), "fire": Number(fire, 0.1)}
        found.candidates.append(Candidate(1, 1, numbers, iso + fire))
    assert [(each.grades["iso"].value, each.grades["fire"].value) for each in found.front()] == [
        (85, 30), (80, 40), (70, 60),
    ]  # fmt: skip
