"""Sweeps: a row for every scene, resumed where they were, and never mixed with another's."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from culet.batch import sweep as sweeping
from culet.batch.metrics import MetricEffort, outline_mask
from culet.batch.sweep import Sweep, journal_of, run
from culet.batch.variation import variation
from culet.errors import InputError
from culet.geometry.designs.solid import shape_of_design
from culet.scene import Scene
from culet.stage import Library, Stage
from culet.stills import render_stage
from geometry.designs.files import design

QUICK = MetricEffort(grade_error=5, width=64, height=36, samples=2)
DEFAULT = Stage.of(Scene())
SCALES = Sweep(DEFAULT, (variation("scale=1,2"),), ("seconds",), QUICK)


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as text:
        return list(csv.DictReader(text))


def test_every_combination_has_its_grades_and_a_scene_that_cannot_be_its_reason(tmp_path: Path) -> None:
    wavy = Library({"m": shape_of_design(design("13_chiral_negative_wheel"))})
    stage = Stage.of(Scene.read({"stones": [{"mesh": "m"}]}), wavy)
    both = variation("recut.girdle_percent=2,4"), variation("material=diamond,quartz")
    out = tmp_path / "a.csv"
    assert list(run(Sweep(stage, both, ("iso", "fire"), QUICK), out)) == [(n, 4) for n in range(5)]
    found = rows(out)
    assert [(row["recut.girdle_percent"], row["material"]) for row in found] == [
        ("2", "diamond"), ("2", "quartz"), ("4", "diamond"), ("4", "quartz"),
    ]  # fmt: skip
    assert all("expected more than 3.117" in row["problem"] and row["iso"] == "" for row in found[:2])
    diamond, quartz = (float(row["iso"]) for row in found[2:])
    assert diamond > quartz + 5
    assert all(0 < float(row["iso_error"]) < 2.5 and row["problem"] == "" for row in found[2:])


def test_the_radiance_of_a_stone_is_the_mean_over_its_outline(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    asked = Sweep(DEFAULT, (variation("film.exposure=1"),), ("radiance", "error", "seconds"), QUICK)
    assert list(run(asked, out))[-1] == (1, 1)
    (row,) = rows(out)
    picture = render_stage(DEFAULT, QUICK.width, QUICK.height, samples=QUICK.samples)
    mask = outline_mask(DEFAULT, None, QUICK.width, QUICK.height)
    assert float(row["radiance"]) == pytest.approx(float(picture.linear[mask].mean()), rel=1e-6)
    assert float(row["error"]) == pytest.approx(picture.missed.error, rel=1e-6)
    assert float(row["seconds"]) > 0


def test_the_outline_of_a_stone_is_where_the_picture_shows_it() -> None:
    """In a white furnace a stone is as bright as the sky, and so is seen before a black backdrop alone."""
    scene = Scene.read({
        "camera": {"kind": "orthographic", "position": [0, 3, 9]}, "floor": {"kind": "none"},
        "environment": {"kind": "constant"}, "backdrop": {"kind": "plain", "colour": [0, 0, 0]}, "head": None,
    })  # fmt: skip
    stage = Stage.of(scene)
    bright = render_stage(stage, 96, 54, samples=4).linear.mean(axis=2) > 0.5
    mask = outline_mask(stage, None, 96, 54)
    assert mask.sum() > 500
    assert np.mean(bright != mask) < 0.02  # the pixels that its edge passes


def test_a_sweep_that_was_interrupted_goes_on_and_measures_nothing_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured: list[float] = []

    def measure(_sums: object, stage: Stage, *_: object) -> dict[str, float]:
        scale = stage.scene.stones[0].scale
        measured.append(scale)
        if scale == 3 and measured.count(3) == 1:
            raise KeyboardInterrupt
        return {"seconds": math.nan if scale == 2 else scale}

    monkeypatch.setattr(sweeping, "measure", measure)
    out = tmp_path / "a.csv"
    asked = replace(SCALES, variations=(variation("scale=1:4:1"),))
    with pytest.raises(KeyboardInterrupt):
        list(run(asked, out))
    assert [row["seconds"] for row in rows(out)] == ["1.0", ""], "what is known is in the table"
    assert list(run(asked, out)) == [(2, 4), (3, 4), (4, 4)]
    assert measured == [1, 2, 3, 3, 4]
    assert [row["seconds"] for row in rows(out)] == ["1.0", "", "3.0", "4.0"]
    assert list(run(asked, out)) == [(4, 4)], "it is finished"


def test_another_sweep_is_refused_unless_it_begins_anew(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    list(run(SCALES, out))
    was = out.read_bytes(), journal_of(out).read_bytes()
    for other, said in (
        (replace(SCALES, variations=(variation("scale=1,3"),)), r"vary\.scale\.1 2, now 3\)"),
        (replace(SCALES, variations=(variation("scale=1,2,4"),)), r"vary\.scale \[1, 2\], now \[1, 2, 4\]\)"),
        (replace(SCALES, metrics=("radiance",)), r"metrics"),
        (replace(SCALES, effort=MetricEffort(width=32, height=36, samples=2)), r"effort\."),
        (replace(SCALES, stage=Stage.of(Scene.read({"stones": [{"cut": "oval"}]}))), r"scene\.stones\.0\.cut"),
    ):
        with pytest.raises(InputError, match=rf"of another sweep \({said}.* --fresh"):
            list(run(other, out))
        assert (out.read_bytes(), journal_of(out).read_bytes()) == was
    list(run(replace(SCALES, variations=(variation("scale=3"),)), out, fresh=True))
    assert [row["scale"] for row in rows(out)] == ["3"]


def test_a_sweep_that_is_going_on_is_not_begun_a_second_time(tmp_path: Path) -> None:
    steps = run(SCALES, tmp_path / "a.csv")
    next(steps)
    with pytest.raises(InputError, match="is in use: another process is at this sweep"):
        list(run(SCALES, tmp_path / "a.csv"))
    steps.close()


def test_a_metric_that_there_is_not_is_refused(tmp_path: Path) -> None:
    for metrics, said in ((("dclr",), "expected one of iso, "), (("iso", "iso"), "more than once")):
        with pytest.raises(InputError, match=said):
            list(run(replace(SCALES, metrics=metrics), tmp_path / "a.csv"))
    assert list(tmp_path.iterdir()) == []
