"""Paths of several stones: each as it would be alone while none touches another, and one table for all."""

from __future__ import annotations

import csv
import json
import pathlib

import numpy as np
import PIL.Image
import pytest

from culet.errors import TooLargeError
from culet.scene import Scene
from culet.simulation.recording.paths import MAX_STEPS, record, write
from culet.simulation.recording.plot import plot
from culet.simulation.recording.several_paths import SeveralPaths, record_several
from culet.simulation.staged import dropped
from culet.stage import Stage

APART = Scene.read({"version": 2, "stones": [{"id": "a"}, {"id": "b", "position": [3, 5, 0], "spin": [0.5, 3, 0]}]})
NAMES = ("stone", "step", "time", "position_x", "orientation_w", "velocity_y", "angular_velocity_z", "energy", "asleep")


@pytest.fixture(scope="module")
def paths() -> SeveralPaths:
    return record_several(dropped(Stage.of(APART)), 0.5)


def test_stones_that_do_not_touch_fall_as_each_would_alone(paths: SeveralPaths) -> None:
    stage = dropped(Stage.of(APART))
    for number, stone in enumerate(stage.scene.stones):
        alone = record(Stage.of(stage.scene.model_copy(update={"stones": (stone,)})), 0.5)
        assert paths.time == pytest.approx(alone.time, abs=1e-12)
        assert abs(paths.position[:, number] - alone.position).max() < 1e-9  # measured 2e-15: until it lands
        assert abs(paths.orientation[:, number] - alone.orientation).max() < 1e-6  # measured 1e-8


def test_stones_on_the_floor_are_lifted_together(paths: SeveralPaths) -> None:
    first, second = APART.stones
    lifts = paths.position[0, :, 1] - [first.position[1], second.position[1]]
    assert lifts[0] == pytest.approx(lifts[1], abs=1e-12)
    assert paths.position[0, 0, 1] == pytest.approx(1.5)


def test_a_table_has_a_row_for_each_step_and_stone(paths: SeveralPaths, tmp_path: pathlib.Path) -> None:
    write(paths, tmp_path / "paths.csv")
    with (tmp_path / "paths.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert set(NAMES) < rows[0].keys()
    assert len(rows) == 2 * len(paths.time)
    assert [row["stone"] for row in rows[:4]] == ["a", "b", "a", "b"]
    last = rows[-1]
    assert (last["stone"], int(last["step"])) == ("b", paths.step[-1])
    assert float(last["position_y"]) == paths.position[-1, 1, 1]


def test_all_formats_hold_the_same(paths: SeveralPaths, tmp_path: pathlib.Path) -> None:
    for ending in ("json", "npz"):
        write(paths, tmp_path / f"paths.{ending}")
    document = json.loads((tmp_path / "paths.json").read_text())
    assert document["columns"]["position_y"] == paths.position[..., 1].ravel().tolist()
    assert document["columns"]["stone"][:2] == ["a", "b"]
    with np.load(tmp_path / "paths.npz") as arrays:
        assert (arrays["position"] == paths.position).all()
        assert arrays["stone"].tolist() == ["a", "b"]


def test_a_plot_has_a_curve_for_each_stone(paths: SeveralPaths, tmp_path: pathlib.Path) -> None:
    alone = record(Stage.of(APART.model_copy(update={"stones": APART.stones[:1]})), 0.5)
    inks = []
    for path in (paths, alone):
        plot(path, tmp_path / "plot.png")
        with PIL.Image.open(tmp_path / "plot.png") as image:
            pixels = np.asarray(image.convert("RGB"), int)
        inks.append(int((abs(pixels - pixels.mean(axis=2, keepdims=True)).max(axis=2) > 30).sum()))
    assert inks[0] > 1.5 * inks[1]


def test_too_many_steps_of_all_stones_together_are_refused() -> None:
    seconds = 0.6 * MAX_STEPS * APART.simulation.time_step
    with pytest.raises(TooLargeError, match="2 stones"):
        record_several(Stage.of(APART), seconds)
