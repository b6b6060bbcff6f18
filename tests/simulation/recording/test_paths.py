"""Recorded paths: what is in them, that files hold the same doubles, and that nothing half-written is left."""

from __future__ import annotations

import csv
import json
import math
import os
import pathlib

import numpy as np
import pytest

from culet.errors import InputError, SceneError, TooLargeError
from culet.geometry.shape import Shape
from culet.scene import Scene, preset
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.recording.paths import MAX_STEPS, StonePath, record, write
from culet.stage import Stage
from shared.stages import staged


@pytest.fixture(scope="module")
def path(box: Shape) -> StonePath:
    return record(staged(preset("classic"), box), 10)


def names(folder: pathlib.Path) -> list[str]:
    return [entry.name for entry in folder.iterdir()]


def test_ten_seconds_are_the_start_and_three_hundred_steps(path: StonePath) -> None:
    assert path.step.tolist() == list(range(301))
    assert path.time[-1] == pytest.approx(10, rel=1e-13, abs=0)
    assert {len(column) for column in path.columns().values()} == {301}


def test_a_path_is_the_simulations(path: StonePath, box: Shape) -> None:
    moving = Simulation.of(Stage(preset("classic"), (box,), None))
    for index in range(301):
        state = moving.state
        assert tuple(path.position[index]) == state.position
        assert tuple(path.orientation[index]) == state.orientation
        assert tuple(path.velocity[index]) == moving.body.velocity(state)
        assert tuple(path.angular_velocity[index]) == moving.body.angular_velocity(state)
        assert path.energy[index] == moving.energy()
        assert (path.asleep[index], path.impacts[index], path.coarse[index]) == (state.asleep, state.impacts, 0)
        moving.step()


def test_a_path_counts_the_steps_that_were_too_full_to_follow(box: Shape) -> None:
    spin = {"gravity": 1e6, "spin": (6000, 9000, 4000), "time_step": 0.1}
    scene = Scene.read({"simulation": spin, "stones": [{"position": [0, 0, 0]}]})
    coarse = record(staged(scene, box), 0.3).coarse.tolist()
    assert coarse == sorted(coarse)
    assert (coarse[0], coarse[1]) == (0, 1)


def test_the_sphere_touches_at_rest_and_not_in_the_air(path: StonePath) -> None:
    assert path.contacts[0] == 0
    assert path.contacts[-1] == 1
    assert ((path.position[:, 1] <= 0) == (path.contacts == 1)).all()
    assert (path.penetration == 0).all()


def test_the_clearance_is_that_of_the_lowest_turned_vertex(path: StonePath, box: Shape) -> None:
    upright = 4 + 1 - 3 / 7  # half an edge of 6/7 below the centre
    assert path.clearance[0] == pytest.approx(upright, rel=1e-14, abs=0)  # measured 0
    for index in (50, 300):
        w, x, y, z = path.orientation[index]
        row = np.array([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)])
        lowest = (box.vertices @ row).min() + path.position[index, 1] + 1
        assert path.clearance[index] == pytest.approx(lowest, abs=1e-15)


def test_the_sphere_holds_the_resting_stone_off_the_floor(path: StonePath) -> None:
    assert path.asleep[-1]
    assert path.clearance[-1] > 0.01  # measured 0.04 R: no vertex touches, which is the classic model's known flaw


def test_a_start_inside_the_floor_is_recorded_as_penetration(box: Shape) -> None:
    inside = record(staged(preset("classic").moved(((0, -0.25, 0), (1, 0, 0, 0))), box), 0.1)
    assert inside.penetration[0] == 0.25
    assert inside.penetration[1] == 0


def test_the_rigid_model_records_its_own_vertices_at_floor_and_walls(box: Shape) -> None:
    scene = Scene.read({"walls": {"kind": "matte"}, "simulation": {"spin": [0, 0, 0]}})
    behind = record(staged(scene.moved(((0, 2, -7.9), (1, 0, 0, 0))), box), 0.1)
    assert behind.penetration[0] == pytest.approx(2 / 7 - 0.1)  # the wall is at z = -8
    assert behind.penetration[1:].max() < 1e-9
    resting = record(staged(scene.moved(((0, -4 / 7, 0), (1, 0, 0, 0))), box), 0.1)
    assert resting.asleep[-1]
    assert resting.contacts[-1] == 4
    assert resting.clearance[-1] == pytest.approx(0, abs=1e-12)


def test_a_time_between_two_steps_ends_at_the_earlier(box: Shape) -> None:
    scene = Scene.read({"simulation": {"time_step": 0.1}})
    assert record(staged(scene, box), 0.3).step[-1] == 3  # 0.3 / 0.1 = 2.9999999999999996
    assert record(staged(scene, box), 0.39).step[-1] == 3
    assert record(staged(scene, box), 0).step.tolist() == [0]


def test_progress_ends_at_one(box: Shape) -> None:
    parts: list[float] = []
    record(staged(Scene.read({"simulation": {"time_step": 0.001}}), box), 2.5, parts.append)
    assert parts == sorted(parts)
    assert len(parts) == 4
    assert parts[-1] == 1


def test_csv_reads_back_as_the_same_doubles(path: StonePath, tmp_path: pathlib.Path) -> None:
    write(path, tmp_path / "path.csv")
    with (tmp_path / "path.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header[:6] == ["step", "time", "position_x", "position_y", "position_z", "orientation_w"]
    assert len(rows) == 301
    for name, texts in zip(header, zip(*rows, strict=True), strict=True):
        assert [float(text) for text in texts] == path.columns()[name].tolist()


def test_json_reads_back_as_the_same_doubles_and_settings(path: StonePath, tmp_path: pathlib.Path) -> None:
    write(path, tmp_path / "path.json")
    document = json.loads((tmp_path / "path.json").read_text())
    assert document["columns"] == {name: column.tolist() for name, column in path.columns().items()}
    assert Scene.read({"simulation": document["simulation"]}).simulation == preset("classic").simulation


def test_npz_reads_back_as_the_same_arrays_and_settings(path: StonePath, tmp_path: pathlib.Path) -> None:
    write(path, tmp_path / "path.NPZ")
    with np.load(tmp_path / "path.NPZ", allow_pickle=False) as arrays:
        assert (arrays["orientation"] == path.orientation).all()
        assert (arrays["asleep"] == path.asleep).all()
        assert arrays["position"].shape == (301, 3)
        assert json.loads(str(arrays["simulation"])) == path.settings


@pytest.mark.parametrize("name", ["path.txt", "path", ".csv", "path.csv.gz"])
def test_an_unknown_ending_is_refused(path: StonePath, tmp_path: pathlib.Path, name: str) -> None:
    with pytest.raises(InputError, match=r"\.csv, \.json, \.npz; got"):
        write(path, tmp_path / name)
    assert names(tmp_path) == []


def test_a_folder_that_is_not_there_is_refused(path: StonePath, tmp_path: pathlib.Path) -> None:
    with pytest.raises(InputError, match="No such file or directory"):
        write(path, tmp_path / "nowhere" / "path.csv")


def test_a_folder_in_the_files_place_is_refused_and_nothing_is_left(path: StonePath, tmp_path: pathlib.Path) -> None:
    (tmp_path / "path.csv").mkdir()
    with pytest.raises(InputError, match="Is a directory"):
        write(path, tmp_path / "path.csv")
    assert names(tmp_path) == ["path.csv"]


def test_a_write_that_fails_leaves_the_old_file_whole(
    path: StonePath, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "path.csv"
    file.write_text("what was there before")

    def full_disk(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(InputError, match="No space left on device"):
        write(path, file)
    assert file.read_text() == "what was there before"
    assert names(tmp_path) == ["path.csv"]


def test_an_old_file_is_replaced(path: StonePath, tmp_path: pathlib.Path) -> None:
    file = tmp_path / "path.csv"
    file.write_text("old")
    write(path, file)
    assert file.read_text().startswith("step,time,")
    assert names(tmp_path) == ["path.csv"]


@pytest.mark.parametrize("seconds", [-1.0, math.nan, math.inf])
def test_a_time_that_is_none_is_refused(box: Shape, seconds: float) -> None:
    with pytest.raises(InputError, match="seconds"):
        record(staged(Scene(), box), seconds)


def test_more_steps_than_the_limit_are_refused(box: Shape) -> None:
    with pytest.raises(TooLargeError, match=f"at most {MAX_STEPS}"):
        record(staged(Scene(), box), MAX_STEPS)


def test_a_scene_without_a_stone_is_refused(box: Shape) -> None:
    with pytest.raises(SceneError, match="stone"):
        record(staged(Scene(stones=()), box), 1)
