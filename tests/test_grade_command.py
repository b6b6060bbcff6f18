"""`culet grade` as a user has it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from command_line import Run, invoke
from geometry.designs.files import FOLDER


def refused(run: Run) -> str:
    """The one line that says why not."""
    assert run.returncode == 1
    (line,) = run.stderr.splitlines()
    return line


def test_a_design_is_graded_by_gemrays_rules_and_by_its_own_index(tmp_path: Path) -> None:
    out = tmp_path / "grades.json"
    design = FOLDER / "05_princess.asc"
    run = invoke("grade", design, "--index", "2.4175", "--as", "gemray", "--error", "0.5", "-o", out)
    assert run.returncode == 0, run.stderr
    report = json.loads(out.read_text())
    assert report["index"] == pytest.approx(2.4175)
    assert report["grades"]["iso"]["value"] == pytest.approx(59.57, abs=1)  # GemRay's; the error asked for is 0.5
    assert report["grades"]["fire"]["value"] == 0
    assert "ISO brightness" in run.stdout
    assert "weighted light return" in run.stdout
    assert " mm, " in run.stdout


def test_a_cut_is_graded_with_its_tilt_curves() -> None:
    run = invoke("grade", "oval,length_to_width=1.6", "--material", "sapphire", "--tilt", "--error", "1")
    assert run.returncode == 0, run.stderr
    assert "1.7681" in run.stdout  # sapphire's ordinary ray at the sodium line
    assert "tilt about x" in run.stdout
    assert run.stdout.count("\n") > 2 * 37


def test_an_error_that_all_rays_do_not_reach_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("culet.grading.grades.MOST_PIECES", 1)
    run = invoke("grade", "single", "--error", "0.001")
    assert run.returncode == 0, run.stderr
    assert "not 0.001: all rays are used" in " ".join(run.stdout.split())
    assert "all rays are used" not in invoke("grade", "single", "--error", "10").stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["heart"], "heart: expected a convex stone"),
        (["--as", "agl"], "as: expected culet or gemray, got 'agl'"),
        (["--stone", "ruby"], "stone: expected the id of a stone"),
        (["--material", "cheese"], "material"),
        (["--material", "ruby", "--index", "1.5"], "expected a material or an index, got both"),
        (["oval,length=2"], "cut.length: unknown field"),
        (["missing.asc"], "missing.asc: cannot be read"),
        (["-o", "grades.txt"], "out: expected a name that ends in .json"),
    ],
)
def test_what_cannot_be_graded_is_refused_in_one_line(arguments: list[str], message: str) -> None:
    assert message in refused(invoke("grade", *arguments))
