"""The study of the renderer from beginning to end on a tiny picture: its report, and how it survives interruption."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from culet.errors import InputError
from culet.optics.panoramas import Panorama, light_box
from culet.rendering.opencl.device import Device
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.study import studies
from culet.study.findings.journal import PointJournal
from culet.study.renderer import race
from culet.study.renderer.knobs import base_knobs
from culet.study.renderer.renderers import Renderers
from culet.study.renderer.shot import Shot
from culet.study.report import Report
from culet.study.studies import StudyEffort, study_rendering
from shared.stages import staged

TINY = StudyEffort(48, 27, 32, 4, 1, 0, 0.0, 0)
GROUPS = frozenset({"cutoff", "samples", "scale"})

Advance = Callable[[str, int], None]


class Told:
    """A progress that remembers, and stops the study where it is asked to."""

    def __init__(self, stop_at: str | None = None) -> None:
        self.labels: list[str] = []
        self.stop_at = stop_at

    @contextlib.contextmanager
    def __call__(self, stage: str, steps: int) -> Iterator[Advance]:
        def advance(label: str, done: int) -> None:
            assert done <= steps
            if stage == "settings":
                if label == self.stop_at:
                    raise KeyboardInterrupt
                self.labels.append(label)

        yield advance


def study(
    out: Path, cache: Path, progress: Told, scene: Scene | None = None, panorama: Panorama | None = None
) -> Report:
    subject = scene or Scene()
    studied = staged(subject, panorama=panorama)
    return study_rendering(studied, out, progress, effort=TINY, quick=True, cache=cache, groups=GROUPS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module")
def finished(folder: Path) -> Report:
    """Interrupted before its last settings, and taken up again."""
    with pytest.raises(KeyboardInterrupt):
        study(folder / "report", folder / "cache", Told(stop_at="samples 4"))
    kept = (folder / "report" / "journal.jsonl").read_text()
    report = study(folder / "report", folder / "cache", Told())
    assert (folder / "report" / "journal.jsonl").read_text().startswith(kept)
    assert kept.count("\n") > 3
    return report


def error(report: Report, label: str, figure: str) -> float:
    (value,) = [point.figures[figure] for point in report.points if point.label == label]
    assert value is not None
    return value


def test_an_interrupted_study_ends_up_with_every_point_once(finished: Report) -> None:
    labels = [point.label for point in finished.points]
    assert len(set(labels)) == len(labels)
    assert {"base", "cutoff 0.1", "samples 4", "samples 16", "scale 0.5"} <= set(labels)


def test_the_files_are_the_report(finished: Report, folder: Path) -> None:
    assert Report.read(folder / "report" / "report.json") == finished
    page = (folder / "report" / "report.html").read_text()
    assert not re.search(r"""https?:|src="(?!data:)|<link|<script|@import|url\(""", page)
    assert page.count('src="data:image/png;base64,') >= 2 * 4 + 1  # reference, base, cutoff 0.1, scale 0.5; the scale
    assert len((folder / "report" / "report.csv").read_text().splitlines()) == len(finished.points) + 1


def test_more_samples_come_nearer_to_the_reference(finished: Report) -> None:
    assert error(finished, "samples 16", "rmse_model") < 0.6 * error(finished, "base", "rmse_model")  # measured 0.25


def test_a_lower_cutoff_is_nearer_to_the_same_samples(finished: Report) -> None:
    errors = [error(finished, f"cutoff {cutoff}", "rmse_paired") for cutoff in ("0.1", "0.02", "0.003")]
    assert errors == sorted(errors, reverse=True)
    assert errors[0] > 3 * errors[-1] > 0


def test_what_is_cut_darkens(finished: Report) -> None:
    assert error(finished, "cutoff 0.1", "bias_paired") < 0


def test_the_fronts_first_point_is_the_fastest(finished: Report) -> None:
    swept = [point for point in finished.points if point.group != "race"]
    for frontier in finished.frontiers:
        judged = [point for point in swept if point.figures[frontier.error] is not None]
        if frontier.error == "rmse_paired":
            judged = [point for point in judged if point.knobs["samples"] == 1]
        fastest = min(judged, key=lambda point: point.figures[frontier.cost] or 0)
        assert frontier.keys[0] == fastest.key


def test_no_picture_holds_a_number_that_is_not_finite(finished: Report) -> None:
    assert all(point.figures["non_finite"] == 0 for point in finished.points)


def test_limits_of_the_machine_are_no_less_than_what_the_renderer_takes(finished: Report) -> None:
    (share,) = [line.value for line in finished.headlines if "share" in line.name]
    assert 0 < share < 100
    assert finished.limits["single_flops"] > 1e9  # any processor since 2005 has more
    assert finished.limits["bandwidth_per_second"] > 1e8


def test_the_folder_of_another_scene_is_refused(finished: Report, folder: Path) -> None:
    assert finished.points
    with pytest.raises(InputError, match="scene"):
        study(folder / "report", folder / "cache", Told(), Scene(head=None))


def test_the_folder_of_another_sky_is_refused(finished: Report, folder: Path) -> None:
    assert finished.points
    with pytest.raises(InputError, match="sky"):
        study(folder / "report", folder / "cache", Told(), panorama=light_box(8))


def test_a_sky_from_a_file_is_what_is_rendered(device: Device) -> None:
    scene = legacy({"environment": {"kind": "image", "image": "file"}, "floor": {"kind": "none"}})
    grey, white = (np.full((4, 8, 3), level, np.float32) for level in (0.5, 1.0))
    means = []
    for panorama in (grey, white):
        stage = staged(scene, panorama=panorama)
        picture = Renderers(device).picture(base_knobs(stage, device.lanes), Shot(stage, 32, 18))
        picture.refine()
        means.append(picture.linear().mean())
    assert means[1] == pytest.approx(2 * means[0], rel=1e-5)


def test_a_race_is_run_once_and_tells_its_references_error(
    device: Device, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(race, "mitsuba_missing", lambda: True)
    effort = TINY._replace(width=16, height=9, race_samples=16, race_seconds=0.2)
    with PointJournal(tmp_path / "j", {"study": "rendering"}) as journal:
        first, *_ = studies._run_race(Renderers(device), effort, journal, Told(), tmp_path)
        assert {point.knobs["renderer"] for point in journal.points.values()} == set(race.ENTRANTS)
        assert {point.knobs["samples"] for point in journal.points.values()} <= {1, 2, 4}
    assert re.search(r"an RMSE of some 0\.\d+\. It is of 12 samples", first)
    before = (tmp_path / "j").read_text()
    with PointJournal(tmp_path / "j", {"study": "rendering"}) as journal:
        assert studies._run_race(Renderers(device), effort, journal, Told(), tmp_path)[0] == first
    assert (tmp_path / "j").read_text() == before


def test_a_finished_study_measures_nothing_again(finished: Report, folder: Path) -> None:
    before = (folder / "report" / "journal.jsonl").read_bytes()
    again = study(folder / "report", folder / "cache", Told())
    assert (folder / "report" / "journal.jsonl").read_bytes() == before
    assert again.points == finished.points
