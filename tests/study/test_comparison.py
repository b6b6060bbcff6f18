"""Two reports, or two benches, as ratios."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from culet.errors import InputError
from culet.study.comparison import compare, compare_benches, medians
from culet.study.report import Figure
from study.reports import report


def test_half_the_time_is_a_ratio_of_a_half() -> None:
    found = compare(report(0.5), report(0.25))
    assert medians(found.ratios) == {"frame_seconds": 0.5, "rmse_model": 1}  # `cut` is null and has none
    assert found.warnings == []


def test_points_that_only_one_has_are_named() -> None:
    whole = report()
    found = compare(whole, report(points=whole.points[:1]))
    assert (found.only_before, found.only_after) == (["samples=4"], [])
    assert {ratio.label for ratio in found.ratios} == {whole.points[0].label}


def test_what_was_measured_under_other_conditions_is_said() -> None:
    other = report(settings={"width": 64}, provenance={"processor": "Q"})
    assert len(compare(report(), other).warnings) == 3  # settings, processor, units


def test_reports_of_different_studies_are_refused() -> None:
    with pytest.raises(InputError, match="rendering and streaming"):
        compare(report(), report(study="streaming", fronts=()))


def test_something_out_of_nothing_is_infinite_and_not_in_the_median() -> None:
    whole = report()
    before = whole.points[0].model_copy(update={"figures": {"cut": 0.0}})
    after = whole.points[0].model_copy(update={"figures": {"cut": 0.1}})
    found = compare(report(points=(before,)), report(points=(after,)))
    assert [ratio.ratio for ratio in found.ratios] == [math.inf]
    assert medians(found.ratios) == {}


def test_a_mean_error_of_either_sign_has_no_ratio() -> None:
    signed = {"bias": Figure(unit="radiance", better="neither", about="Mean error.")}
    points = [report().points[0].model_copy(update={"figures": {"bias": value}}) for value in (0.1, -0.2)]
    before, after = (report(points=(point,), figures=signed, fronts=()) for point in points)
    assert compare(before, after).ratios == []


def bench(path: Path, seconds: float, **changes: object) -> Path:
    old = {"machine": {"processor": "P"}, "cases": [{"name": "default", "seconds": 9.0}]}
    line = {"machine": {"processor": "P"}, "cases": [{"name": "default", "seconds": seconds}], **changes}
    path.write_text(f"{json.dumps(old)}\n{json.dumps(line)}\n\n")
    return path


def test_the_last_lines_of_two_benches_are_compared(tmp_path: Path) -> None:
    found = compare_benches(bench(tmp_path / "a", 0.1), bench(tmp_path / "b", 0.3, machine={"processor": "Q"}))
    assert [(ratio.label, ratio.figure) for ratio in found.ratios] == [("default", "seconds")]
    assert found.ratios[0].ratio == pytest.approx(3)
    assert len(found.warnings) == 1


@pytest.mark.parametrize("content", ["", "{}", "nonsense", '{"cases": [1]}'])
def test_a_file_that_is_no_bench_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "b").write_text(content)
    with pytest.raises(InputError, match="culet bench"):
        compare_benches(bench(tmp_path / "a", 1), tmp_path / "b")
