"""Snapshots that came from outside: what is refused, and with which words."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from typing import Any

import pytest

from culet.errors import InputError
from culet.simulation.one_stone.snapshot import read_snapshot, write_snapshot
from culet.simulation.rigid_body.state import RigidState

BEFORE = RigidState(6, 0.2, (0.1, 2.0, 1 / 3), (1.0, 0.0, 0.0, 0.0), (0.0, -1e-300, 5.0), (0.1, 0.2, 0.3))
AFTER = RigidState(7, 0.7 / 3, (0.1, 1.9, 0.5), (0.6, 0.0, -0.8, 0.0), (0.0, -1.0, 5.0), (0.1, 0.2, 0.3), 2, True)


def changed(path: str, value: object) -> dict[str, Any]:
    """A good snapshot with one place changed."""
    snapshot = copy.deepcopy(write_snapshot(AFTER, BEFORE))
    *way, last = path.split(".")
    place = snapshot
    for part in way:
        place = place[part]
    place[last] = value
    return snapshot


def test_a_snapshot_reads_back_as_the_same_states() -> None:
    text = json.dumps(write_snapshot(AFTER, BEFORE), allow_nan=False)
    assert read_snapshot(json.loads(text)) == (AFTER, BEFORE)


def test_a_snapshot_from_before_coarse_steps_were_counted_has_none() -> None:
    snapshot = write_snapshot(replace(AFTER, coarse=3), BEFORE)
    assert read_snapshot(snapshot)[0].coarse == 3
    del snapshot["state"]["coarse"]
    assert read_snapshot(snapshot)[0] == AFTER


def test_whole_numbers_may_stand_for_floats() -> None:
    state, _ = read_snapshot(changed("state.momentum", [0, -1, 5]))
    assert state == AFTER
    assert all(isinstance(component, float) for component in state.momentum)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("version", 2, "version"),
        ("extra", 1, "extra"),
        ("state", None, "state"),
        ("state.step", -1, r"state\.step"),
        ("state.step", 7.5, r"state\.step"),
        ("state.step", True, r"state\.step"),
        ("state.step", 9, "one step before"),
        ("state.time", float("nan"), r"state\.time"),
        ("state.time", -1.0, r"state\.time"),
        ("state.position", [0.0, 1.0], r"state\.position"),
        ("state.position", [0.0, 1.0, float("nan")], r"state\.position\.2"),
        ("state.position", [0.0, 1.0, float("inf")], r"state\.position\.2"),
        ("state.position", [0.0, 1.0, 1e31], r"state\.position\.2"),
        ("state.position", [0.0, 1.0, "2"], r"state\.position\.2"),
        ("state.position", [0.0, 1.0, True], r"state\.position\.2"),
        ("state.orientation", [0.0, 0.0, 0.0, 0.0], "unit quaternion"),
        ("state.orientation", [1.0, 0.1, 0.0, 0.0], "unit quaternion"),
        ("previous.momentum", "fast", r"previous\.momentum"),
        ("previous.angular_momentum", None, r"previous\.angular_momentum"),
        ("previous.impacts", -3, r"previous\.impacts"),
        ("previous.asleep", 1, r"previous\.asleep"),
        ("previous.mood", "calm", r"previous\.mood"),
    ],
)
def test_nonsense_is_refused_by_name(path: str, value: object, message: str) -> None:
    with pytest.raises(InputError, match="simulation snapshot: .*" + message):
        read_snapshot(changed(path, value))


@pytest.mark.parametrize("data", [None, 3, "state", [], {}])
def test_what_is_no_snapshot_at_all_is_refused(data: object) -> None:
    with pytest.raises(InputError, match="simulation snapshot"):
        read_snapshot(data)
