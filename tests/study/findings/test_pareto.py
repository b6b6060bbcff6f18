"""The Pareto frontier of a handful of points."""

from __future__ import annotations

from culet.study.findings.pareto import frontier
from culet.study.report import Point


def point(key: str, seconds: float | None, error: float | None) -> Point:
    return Point(key=key, group="g", label=key, knobs={}, figures={"seconds": seconds, "error": error})


def keys(*points: Point) -> tuple[str, ...]:
    return frontier("name", points, "seconds", "error").keys


def test_the_frontier_goes_from_the_fastest_to_the_most_exact() -> None:
    assert keys(point("exact", 9, 0.1), point("fast", 1, 3), point("between", 4, 1)) == ("fast", "between", "exact")


def test_a_point_that_is_slower_and_less_exact_is_not_on_it() -> None:
    assert keys(point("good", 1, 1), point("beaten", 2, 1.5)) == ("good",)


def test_of_two_equally_fast_points_only_the_more_exact_is_on_it() -> None:
    assert keys(point("worse", 1, 2), point("better", 1, 1)) == ("better",)


def test_of_two_equally_exact_points_only_the_faster_is_on_it() -> None:
    assert keys(point("slower", 2, 1), point("faster", 1, 1)) == ("faster",)


def test_points_without_one_of_the_figures_do_not_take_part() -> None:
    assert keys(point("unjudged", 0.1, None), point("untimed", None, 0.0), point("measured", 1, 1)) == ("measured",)
