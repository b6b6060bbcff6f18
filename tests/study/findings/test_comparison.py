"""Two reports as ratios."""

from __future__ import annotations

import math

import pytest

from culet.errors import InputError
from culet.study.findings.comparison import compare_reports, medians
from culet.study.report import Figure
from study.reports import report


def test_half_the_time_is_a_ratio_of_a_half() -> None:
    found = compare_reports(report(0.5), report(0.25))
    assert medians(found.ratios) == {"frame_seconds": 0.5, "rmse_model": 1}  # `cut` is null and has none
    assert found.warnings == []


def test_points_that_only_one_has_are_named() -> None:
    whole = report()
    found = compare_reports(whole, report(points=whole.points[:1]))
    assert (found.only_before, found.only_after) == (["samples=4"], [])
    assert {ratio.label for ratio in found.ratios} == {whole.points[0].label}


def test_what_was_measured_under_other_conditions_is_said() -> None:
    other = report(settings={"width": 64}, provenance={"processor": "Q"})
    assert len(compare_reports(report(), other).warnings) == 3  # settings, processor, units


def test_reports_of_different_studies_are_refused() -> None:
    with pytest.raises(InputError, match="rendering and streaming"):
        compare_reports(report(), report(study="streaming", frontiers=()))


def test_something_out_of_nothing_is_infinite_and_not_in_the_median() -> None:
    whole = report()
    before = whole.points[0].model_copy(update={"figures": {"cut": 0.0}})
    after = whole.points[0].model_copy(update={"figures": {"cut": 0.1}})
    found = compare_reports(report(points=(before,)), report(points=(after,)))
    assert [ratio.ratio for ratio in found.ratios] == [math.inf]
    assert medians(found.ratios) == {}


def test_a_mean_error_of_either_sign_has_no_ratio() -> None:
    signed = {"bias": Figure(unit="radiance", better="neither", about="Mean error.")}
    points = [report().points[0].model_copy(update={"figures": {"bias": value}}) for value in (0.1, -0.2)]
    before, after = (report(points=(point,), figures=signed, frontiers=()) for point in points)
    assert compare_reports(before, after).ratios == []
