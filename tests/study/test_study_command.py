"""`culet study` as a user has it."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import culet, invoke
from study.reports import report


@pytest.mark.parametrize(
    "command",
    [
        "rendering",
        "simulation",
        "streaming",
        "caustics",
        "growth",
        "resting",
        "video",
        "diff",
        "headline",
        "compare-bench",
    ],
)
def test_every_study_explains_itself(command: str) -> None:
    run = invoke("study", command, "--help")
    assert run.returncode == 0
    assert f"culet study {command}" in run.stdout


def test_two_reports_are_compared(tmp_path: Path) -> None:
    for name, seconds in (("a.json", 0.5), ("b.json", 1.0)):
        (tmp_path / name).write_text(report(seconds).json_text())
    run = invoke("study", "diff", tmp_path / "a.json", tmp_path / "b.json")
    assert run.returncode == 0, run.stderr
    assert "2.000  frame_seconds" in run.stdout
    assert "1.000  rmse_model" in run.stdout


def test_a_report_in_short(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(report().json_text())
    assert "| a frame | 1.23 ms |" in invoke("study", "headline", tmp_path / "a.json").stdout


def test_a_scene_without_a_stone_has_nothing_to_study(tmp_path: Path) -> None:
    (tmp_path / "empty.json").write_text('{"stones": []}')
    run = invoke("study", "rendering", tmp_path / "empty.json", "-o", tmp_path / "report")
    assert run.returncode == 1
    assert run.stderr.splitlines() == ["culet: stones: a study needs a stone; the scene has none"]
    assert not (tmp_path / "report").exists()


@pytest.mark.parametrize("command", ["rendering", "simulation", "streaming"])
def test_a_study_without_scikit_image_says_how_to_have_it(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As after `make serve`, which installs only what serving takes."""
    (tmp_path / "skimage.py").write_text("raise ModuleNotFoundError(name='skimage')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    run = culet("study", command, "--quick", "-o", tmp_path / "report")
    assert run.returncode == 1
    assert run.stderr.splitlines() == ["culet: a study needs scikit-image: pip install 'culet[study]'"]
