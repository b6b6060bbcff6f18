"""The study of the light that stones throw, on a few maps: errors fall, estimates and bounds hold."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from culet.errors import SceneError
from culet.scene import Scene
from culet.study.light import caustics
from culet.study.report import Point, Report
from culet.study.studies import study_caustics
from shared.stages import staged
from shared.stones import ring

TINY = caustics.CausticsEffort((3e-3, 3e-4, 3e-5), (1, 4), 3, 1e-6, 1e-4, 8, 1, (1e-3, 1e-4), 1)


@contextlib.contextmanager
def untold(stage: str, steps: int) -> Iterator[Callable[[str, int], None]]:
    def advance(label: str, done: int) -> None:
        assert done < steps, label

    yield advance


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("caustics")


@pytest.fixture(scope="module")
def finished(folder: Path) -> Iterator[Report]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(caustics, "QUICK", TINY)
        patched.setattr("culet.rendering.light.illumination.MOST_PASSES", 6)
        yield study_caustics(staged(Scene()), folder, untold, quick=True)


def of(report: Report, group: str) -> list[Point]:
    return [point for point in report.points if point.group == group]


def value(point: Point, figure: str) -> float:
    found = point.figures[figure]
    assert found is not None, point.key
    return found


def test_a_lower_cutoff_is_nearer_to_the_converged_map(finished: Report) -> None:
    errors = [value(point, "rmse") for point in of(finished, "point: beams")]
    assert len(errors) == 3
    assert errors[0] > 1.5 * errors[1] > 3 * errors[2] > 0


def test_no_more_light_is_missing_than_is_said(finished: Report) -> None:
    judged = [p for name in ("point: beams", "sun: beams", "point: at rest", "poses") for p in of(finished, name)]
    assert len(judged) >= 3 + 6 + 2 + 4
    for point in judged:
        assert value(point, "missing") < value(point, "bound"), point.key
        of_reference = 0.02 if point.group == "sun: beams" else 1e-3  # the sun's is cut itself
        assert value(point, "missing") > -of_reference, point.key


def test_the_estimated_error_is_within_twice_the_true_one(finished: Report) -> None:
    for point in (*of(finished, "poses"), *of(finished, "point: beams"), *of(finished, "point: at rest")):
        assert 0.5 < value(point, "estimate_ratio") < 2, point.key


def test_more_directions_of_a_sun_are_nearer_to_all_of_them(finished: Report) -> None:
    one, four = (min(value(p, "rmse") for p in of(finished, "sun: beams") if p.knobs["passes"] == n) for n in (1, 4))
    assert four < one


def test_photons_come_to_the_same_map_later(finished: Report) -> None:
    for lamp in caustics.LAMPS:
        photons = of(finished, f"{lamp}: photons")
        assert len(photons) == 3
        if lamp == "point":  # the sun's converged map is cut at 1e-4 here
            assert abs(value(photons[-1], "missing")) < 0.005, "as much light"
        beams = min(of(finished, f"{lamp}: beams"), key=lambda p: value(p, "processor_seconds"))
        assert value(beams, "processor_seconds") < value(photons[0], "processor_seconds")
    by_name = {race.name: race for race in finished.races}
    beams_race, photons_race = by_name["point, beams"].seconds["0.01"], by_name["point, photons"].seconds["0.01"]
    assert beams_race is not None
    assert photons_race is None or photons_race > 10 * beams_race


def test_the_files_are_the_report_and_nothing_is_measured_again(
    finished: Report, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert Report.read(folder / "report.json") == finished
    page = (folder / "report.html").read_text()
    assert page.count("<svg") == 3
    monkeypatch.setattr(caustics, "QUICK", TINY)
    before = (folder / "journal.jsonl").read_bytes()
    assert study_caustics(staged(Scene()), folder, untold, quick=True).points == finished.points
    assert (folder / "journal.jsonl").read_bytes() == before


def test_a_stone_that_takes_no_beams_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="convex"):
        study_caustics(staged(Scene(), ring()), tmp_path / "none", untold, quick=True)
    assert not (tmp_path / "none").exists()
