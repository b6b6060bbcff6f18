"""The search of tangent ratios: it finds better designs than it was given, within its means, and the front of all."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import direct

from culet.batch.angle_search import LEAST_REACH, angle_search, free_angles, search_angles
from culet.batch.candidates import BRIGHTNESS, FIRE, Candidate, Candidates, GradeTask, TrialDesign
from culet.batch.crew import IN_PROCESS, Done, InProcess, Item, More, Result, Task
from culet.batch.metrics import light_sums
from culet.batch.search import NO_STONE, divide, search_ratios
from culet.errors import MeshError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.cutting.recut import OF_A_SHAPE, recut_shape
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.shape import FacetName, Shape
from culet.grading.grades import grade
from culet.grading.number import Number
from culet.grading.optics import optics_of
from culet.grading.rules import Rules
from culet.scene.cuts import BrilliantCut, SingleCut
from culet.scene.recut import Recut
from culet.scene.stone import StoneSettings

DIAMOND = optics_of(StoneSettings(), 3.25)


def candidates(shape: Shape, crew: InProcess = IN_PROCESS) -> Candidates:
    """To be searched for brightness and fire."""
    return Candidates(shape, DIAMOND, Rules(), {"iso": 1, "fire": 1}, crew=crew)


def graded(shape: Shape) -> Candidate:
    """As it is, for ISO and fire."""
    grades = next(grade(light_sums(), shape, DIAMOND, Rules()))
    return Candidate(1, 1, {"iso": grades.iso, "fire": grades.fire}, grades.iso.value + grades.fire.value)


def test_a_flat_pavilion_is_found_to_be_too_flat() -> None:
    """At 36 degrees diamond leaks: Tolkowsky's 40.75 is a ratio of 1.186."""
    found = candidates(shape_of_cut(SingleCut(pavilion_degrees=36)))
    search_ratios(found, (0.8, 1.25), (0.9, 1.3), 16)
    given, best = found.found[0], found.best()
    assert len(found.found) <= len(found.graded) <= 17
    assert best.total > given.total + 10
    assert 1.1 < best.pavilion_ratio < 1.3
    front = found.front()
    values = [(each.grades[BRIGHTNESS].value, each.grades[FIRE].value) for each in front]
    assert values == sorted(values, key=lambda pair: (-pair[0], pair[1])), "brighter is less fiery"
    for each in found.found:
        bright, fiery = each.grades[BRIGHTNESS].value, each.grades[FIRE].value
        assert any(a >= bright and b >= fiery for a, b in values)


def test_a_design_has_in_the_search_the_grades_that_it_has_alone() -> None:
    shape = shape_of_cut(SingleCut())
    found = candidates(shape)
    found.grade_given()
    alone = next(grade(light_sums(), shape, DIAMOND, Rules()))
    assert found.found[0].grades["iso"] == alone.iso
    assert found.found[0].total == pytest.approx(alone.iso.value + alone.fire.value)


@pytest.mark.validation
def test_angles_of_single_tiers_find_what_ratios_cannot() -> None:
    """Lower halves as steep as the mains are too flat: no ratio changes the one without the other."""
    shape = shape_of_cut(BrilliantCut(lower_half_percent=40))
    found = candidates(shape)
    found.grade_given()
    (given,) = found.found
    search_angles(found, 3, 9)
    assert len(found.graded) <= 10
    best = found.best()
    assert best.total > given.total + 0.5
    again = recut_shape(shape, Recut(angles=dict(best.angles)))
    assert graded(again).total == pytest.approx(best.total, abs=1e-9)
    assert angle_search(replace(shape, names=()), given, lambda each: each.total, 3, 10) is None


def test_angles_are_searched_within_the_smallest_reach_too() -> None:
    """Smaller than twice the step that is the last otherwise."""
    shape = shape_of_cut(SingleCut())
    start = Candidate(1, 1, {}, 0)
    for reach in (0.01, LEAST_REACH):
        found = candidates(shape)
        search = angle_search(shape, start, lambda each: each.total, reach, 2)
        assert search is not None
        found.run([search], 2)
        own = free_angles(shape)
        assert len(found.found) == 2
        assert all(each.angles == pytest.approx(own, abs=1.001 * reach) for each in found.found)
    assert angle_search(shape, start, lambda each: each.total, 0.9 * LEAST_REACH, 2) is None


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
    found = candidates(shape_of_cut(SingleCut()))
    for iso, fire in ((80, 40), (85, 30), (79, 39), (70, 60), (85, 29), (80, 40)):
        numbers = {"iso": Number(iso, 0.1), "fire": Number(fire, 0.1)}
        found.found.append(Candidate(1, 1, numbers, iso + fire))
    assert [(each.grades["iso"].value, each.grades["fire"].value) for each in found.front()] == [
        (85, 30), (80, 40), (70, 60),
    ]  # fmt: skip


class Landscape(InProcess):
    """Grades by a formula in place of rays, some designs no stone, and gives what it was asked for in another order."""

    def __init__(self, places: int) -> None:
        self._places = places
        self.asked: list[TrialDesign] = []
        self.most_at_a_time = 0

    @property
    def alone(self) -> bool:
        return self._places == 1

    def results(self, task: Task[Item, Result], more: More[Item]) -> Done[Item, Result]:
        """The last that was asked for first."""
        assert isinstance(task, GradeTask)
        begun: list[TrialDesign] = []
        while True:
            begun += [item for item in more(max(0, self._places - len(begun))) if isinstance(item, TrialDesign)]
            if not begun:
                return
            self.most_at_a_time = max(self.most_at_a_time, len(begun))
            design = begun.pop()
            self.asked.append(design)
            yield cast("tuple[Item, Result]", (design, self._graded(design)))  # of a GradeTask

    @staticmethod
    def _graded(design: TrialDesign) -> dict[str, Number] | MeshError:
        crown, pavilion = design.crown_ratio, design.pavilion_ratio
        if crown > 1.1:
            return MeshError("too steep")
        turned = sum(abs(degrees - 41) for _, degrees in design.angles)
        iso = 80 - 200 * (crown - 0.93) ** 2 - 300 * (pavilion - 1.03) ** 2 + math.sin(30 * crown) - turned
        fire = 40 - 150 * (crown - 1.1) ** 2 - 200 * (pavilion - 0.97) ** 2 - turned
        return {"iso": Number(iso, 0.1), "fire": Number(fire, 0.1)}


def _lost(found: Candidate | None) -> float:
    return NO_STONE if found is None else -found.total


def searched(places: int, evaluations: int = 60) -> tuple[Landscape, Candidates]:
    """All parts of a search."""
    crew = Landscape(places)
    found = candidates(shape_of_cut(SingleCut()), crew)
    whole_search(found, evaluations)
    return crew, found


def whole_search(found: Candidates, evaluations: int) -> None:
    """As the command has it."""
    search_ratios(found, (0.8, 1.25), (0.9, 1.1), evaluations // 2)
    search_angles(found, 2, evaluations - len(found.graded))


def test_however_many_grade_side_by_side_the_same_designs_are_found_in_the_same_order() -> None:
    alone, expected = searched(1)
    assert alone.most_at_a_time == 1
    for places in (2, 32):
        crew, found = searched(places)
        assert found.found == expected.found
        assert crew.most_at_a_time >= min(places, 3)
        assert len(crew.asked) == len(set(crew.asked)) == len(alone.asked), "each once"
    assert len(alone.asked) <= 61
    assert None in expected.graded.values(), "no stone"
    assert {bool(each.angles) for each in expected.found} == {False, True}


def test_the_range_is_divided_as_one_design_after_the_other_would_divide_it() -> None:
    """scipy's own calls, one at a time."""
    ends, crew = [(0.8, 1.25), (0.9, 1.1)], Landscape(32)
    found = candidates(shape_of_cut(SingleCut()), crew)
    divide(found, ends, 40, 1000)
    asked = []

    def lost(ratios: NDArray[np.float64]) -> float:
        asked.append(TrialDesign.of(*ratios))
        return _lost(found.graded[asked[-1]])

    direct(lost, ends, maxfun=40)
    assert set(asked) == set(crew.asked)


def test_workers_that_come_and_go_meanwhile_find_the_same_designs_each_once() -> None:
    """One is left at times: what it grades next may wait already, as the others' did."""

    class ComingAndGoing(Landscape):
        alone = False

        def places(self) -> int:
            return self._places

        def results(self, task: Task[Item, Result], more: More[Item]) -> Done[Item, Result]:
            for done in super().results(task, more):
                self._places = (1, 4, 2)[len(self.asked) % 3]
                yield done

    expected, crew = searched(1)[1], ComingAndGoing(4)
    found = candidates(shape_of_cut(SingleCut()), crew)
    whole_search(found, 60)
    assert found.found == expected.found
    assert len(crew.asked) == len(set(crew.asked)), "each once"


@pytest.mark.parametrize("number", [0, 20, 45])
def test_what_was_graded_before_a_search_was_interrupted_is_there(number: int) -> None:
    class Interrupted(Landscape):
        def results(self, task: Task[Item, Result], more: More[Item]) -> Done[Item, Result]:
            for done in super().results(task, more):
                if len(self.asked) > number:
                    raise KeyboardInterrupt
                yield done

    found = candidates(shape_of_cut(SingleCut()), Interrupted(4))
    with pytest.raises(KeyboardInterrupt):
        whole_search(found, 60)
    assert len(found.graded) == number
    assert len(found.found) == sum(each is not None for each in found.graded.values())
