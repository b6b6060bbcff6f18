"""`culet.simulate`, as scripts and notebooks have it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import culet
from culet.errors import InputError

TOSSED = {"stones": [{"id": "gem", "position": [0, 4, 0], "velocity": [1, 0, 0], "spin": [0, 0, 0]}]}


def test_a_stone_falls_as_galileo_has_it() -> None:
    motion = culet.simulate(TOSSED, 0.5)
    gravity = motion.scene.simulation.gravity
    assert motion.stones == ("gem",)
    assert motion.position.shape == motion.velocity.shape == (61, 1, 3)
    assert motion.orientation.shape == (61, 1, 4)
    assert motion.asleep.shape == motion.clearance.shape == (61, 1)
    assert motion.position[:, 0, 0] == pytest.approx(motion.time, abs=1e-9)
    assert motion.position[:, 0, 1] == pytest.approx(4 - gravity * motion.time**2 / 2, abs=1e-6)
    assert motion.velocity[:, 0, 1] == pytest.approx(-gravity * motion.time, abs=1e-6)


def test_several_stones_have_arrays_of_the_same_form() -> None:
    motion = culet.simulate("trio", 0.1)
    assert motion.stones == tuple(stone.id for stone in culet.load_scene("trio").stones)
    assert motion.position.shape == (13, 3, 3)
    assert motion.energy.shape == motion.time.shape == (13,)


def test_a_state_can_be_rendered() -> None:
    motion = culet.simulate(TOSSED, 0.5)
    scene = motion.scene_at(0.3)
    assert scene.stones[0].position == pytest.approx(motion.position[36, 0])
    assert scene.stones[0].orientation == pytest.approx(motion.orientation[36, 0])
    assert scene.camera == motion.scene.camera
    assert not np.array_equal(
        culet.render(scene, 24, 16, samples=1).linear, culet.render(motion.scene, 24, 16, samples=1).linear
    )
    with pytest.raises(InputError, match=r"seconds: expected 0 to 0\.5, got 2"):
        motion.scene_at(2)


def test_a_motion_is_saved_as_the_command_saves_it(tmp_path: Path) -> None:
    motion = culet.simulate(TOSSED, 0.1)
    rows = motion.save(tmp_path / "path.csv").read_text().splitlines()
    assert len(rows) == 1 + len(motion.time)
    with pytest.raises(InputError, match=r"\.csv, \.json, \.npz; got 'path\.xls'"):
        motion.save(tmp_path / "path.xls")


def test_a_scene_without_a_stone_is_said_so() -> None:
    with pytest.raises(InputError, match="a simulation needs a stone"):
        culet.simulate({"stones": []})
