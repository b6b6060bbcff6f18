"""Two lines of `culet bench -o` as ratios, and the line that is committed."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from culet.errors import InputError
from culet.study.bench.baseline import FIGURES, TIMES, compare_benches, doubts, last_line
from culet.study.bench.cases import CASES

COMMITTED = Path(__file__).parents[2] / "benchmarks" / "baseline.jsonl"


def record(first: float, second: float, **machine: str) -> dict[str, Any]:
    cases = [
        {
            "name": name, "seconds": seconds, "processor_seconds": 2 * seconds, "preparation_seconds": seconds / 50,
            "segments": 100, "cut": 0.0, "rmse": 0.01,
        }
        for name, seconds in (("checker", first), ("default", second))
    ]  # fmt: skip
    return {"commit": "abc", "machine": {"processor": "P", **machine}, "width": 640, "height": 360, "cases": cases}


def test_on_one_machine_times_are_compared_as_they_are() -> None:
    found = compare_benches(record(0.1, 0.2), record(0.3, 0.2))
    assert not found.relative
    assert found.remarks == []
    checker, default = found.cases
    assert checker.ratios == pytest.approx({**dict.fromkeys(FIGURES, 1), **dict.fromkeys(TIMES, 3)})
    assert default.ratios["seconds"] == 1


def test_on_another_machine_scenes_are_compared_with_the_first_one() -> None:
    """Twice as fast a machine, on which the second scene has become half as dear again."""
    found = compare_benches(record(0.1, 0.2), record(0.05, 0.15, processor="Q"))
    assert found.relative
    assert [case.ratios["seconds"] for case in found.cases] == pytest.approx([1, 1.5])
    assert found.cases[1].ratios["segments"] == 1
    assert any("processor" in remark and "multiples" not in remark for remark in found.remarks)


def test_another_driver_on_the_same_machine_is_said_and_compared() -> None:
    found = compare_benches(record(0.1, 0.2, driver="3.1"), record(0.2, 0.4, driver="6.0"))
    assert not found.relative
    assert found.cases[0].ratios["seconds"] == 2
    assert len(found.remarks) == 1


def test_scenes_and_figures_that_only_one_has_are_named() -> None:
    before, after = record(0.1, 0.2), record(0.1, 0.2)
    before["cases"].pop()
    del before["cases"][0]["rmse"]
    found = compare_benches(before, after)
    assert [case.name for case in found.cases] == ["checker"]
    assert found.cases[0].ratios["rmse"] is None
    assert found.remarks == ["only after: default"]


def test_at_another_size_segments_are_compared_by_the_pixel() -> None:
    """Twice the width and height: four times the pixels, segments and seconds."""
    larger = record(0.4, 0.8) | {"width": 1280, "height": 720}
    for case in larger["cases"]:
        case["segments"] *= 4
    found = compare_benches(record(0.1, 0.2), larger)
    assert [case.ratios for case in found.cases] == [pytest.approx(dict.fromkeys(FIGURES, 1))] * 2


def test_something_out_of_nothing_is_infinite_and_not_missing() -> None:
    after = record(0.1, 0.2)
    after["cases"][0]["cut"] = 0.1
    found = compare_benches(record(0.1, 0.2), after)
    assert [case.ratios["cut"] for case in found.cases] == [math.inf, 1]


def test_a_line_of_changed_code_or_of_a_busy_machine_is_doubted() -> None:
    """`record` has two units' time in every second."""
    line = record(0.1, 0.2)
    line["machine"]["units"] = 2
    assert doubts(line) == []
    (dirty,) = doubts(line | {"commit": "abc-dirty"})
    assert "abc-dirty" in dirty
    for case in line["cases"]:
        case["seconds"] *= 1.4
    (busy,) = doubts(line)
    assert "1.43 of 2 units" in busy


def test_the_last_line_of_a_file_counts(tmp_path: Path) -> None:
    (tmp_path / "b").write_text(f"{json.dumps(record(1, 2))}\n{json.dumps(record(3, 4))}\n\n")
    assert last_line(tmp_path / "b") == record(3, 4)


@pytest.mark.parametrize("content", ["", "{}", "nonsense", '{"cases": [1]}'])
def test_a_file_that_is_no_bench_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "b").write_text(content)
    with pytest.raises(InputError, match="culet bench"):
        last_line(tmp_path / "b")


def test_the_committed_baseline_has_every_scene_and_figure() -> None:
    line = last_line(COMMITTED)
    assert [case["name"] for case in line["cases"]] == list(CASES)
    assert all(case.keys() >= set(FIGURES) for case in line["cases"])
    assert line.keys() >= {"made", "commit", "machine", "flags", "width", "height"}
    assert line["machine"].keys() >= {"processor", "device", "driver", "units"}


def test_the_committed_baseline_is_of_a_commit() -> None:
    assert not last_line(COMMITTED)["commit"].endswith("-dirty")
