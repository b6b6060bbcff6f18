"""The way that a stone takes, recorded step by step and written to a file."""

from __future__ import annotations

import csv
import io
import json
import math
import pathlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError, SceneError, TooLargeError
from culet.places import write_whole
from culet.simulation.one_stone.simulation import Simulation
from culet.stage import Stage

MAX_STEPS = 500_000
"""Over an hour at the default 120 steps a second. Each recorded step takes about 1 kB while it is turned into text."""

Floats = NDArray[np.float64]
Progress = Callable[[float], None]
"""Called now and then with the part done, 0 to 1."""


@dataclass(frozen=True, eq=False)
class StonePath:
    """N states, the start first; the arrays' first axis is the step."""

    settings: dict[str, Any]
    """The scene's `simulation` with the stone's own mass, spin, velocity, restitution and friction, as JSON."""
    step: NDArray[np.int64]
    """(N,)"""
    time: Floats
    """(N,), s"""
    position: Floats
    """(N, 3), R"""
    orientation: Floats
    """(N, 4), unit quaternion w, x, y, z"""
    velocity: Floats
    """(N, 3), R/s"""
    angular_velocity: Floats
    """(N, 3), world axes, rad/s"""
    energy: Floats
    """(N,), mass R^2/s^2; its potential part is 0 where the centre of mass is 1 R above the floor"""
    asleep: NDArray[np.bool_]
    """(N,)"""
    impacts: NDArray[np.int64]
    """(N,), hard impacts so far"""
    coarse: NDArray[np.int64]
    """(N,), steps so far whose events were too many to be followed exactly; classic: 0"""
    contacts: NDArray[np.int64]
    """(N,), vertices that touch a surface; classic: 1 where the bounding sphere touches the floor"""
    penetration: Floats
    """(N,), how far the deepest vertex is inside a surface, R; classic: how far the bounding sphere is"""
    clearance: Floats
    """(N,), height of the stone's lowest vertex above the floor, R; negative: it is inside the floor"""

    def columns(self) -> dict[str, NDArray[Any]]:
        """One-dimensional arrays by name, with the axis after an underscore: what a table of the path holds."""
        table: dict[str, NDArray[Any]] = {"step": self.step, "time": self.time} | by_axis(self)
        for name in ("energy", "asleep", "impacts", "coarse", "contacts", "penetration", "clearance"):
            table[name] = getattr(self, name)
        return table


class Poses(Protocol):
    """What is recorded of every stone; the arrays' last axis is that of the world."""

    @property
    def position(self) -> Floats:
        """(..., 3), R"""

    @property
    def orientation(self) -> Floats:
        """(..., 4), unit quaternion w, x, y, z"""

    @property
    def velocity(self) -> Floats:
        """(..., 3), R/s"""

    @property
    def angular_velocity(self) -> Floats:
        """(..., 3), world axes, rad/s"""


def by_axis(poses: Poses) -> dict[str, Floats]:
    """One-dimensional arrays by name, with the axis after an underscore."""
    vectors = {
        "position": poses.position,
        "orientation": poses.orientation,
        "velocity": poses.velocity,
        "angular_velocity": poses.angular_velocity,
    }
    return {
        f"{name}_{axis}": vector[..., index].ravel()
        for name, vector in vectors.items()
        for index, axis in enumerate("wxyz" if vector.shape[-1] == 4 else "xyz")
    }


def record(stage: Stage, seconds: float, progress: Progress | None = None) -> StonePath:
    """Let the stage's stone move for `seconds`, in whole steps.

    SceneError if the scene has no stone, InputError for a time that is none, TooLargeError beyond MAX_STEPS.
    """
    scene = stage.scene
    if not scene.stones:
        raise SceneError("stones: a simulation needs a stone; the scene has none", "stones")
    count = whole_steps(seconds, scene.simulation.time_step)
    simulation = Simulation.of(stage)
    path = _empty_path(simulation.settings.model_dump(mode="json"), count + 1)
    for index in range(count + 1):
        if index:
            simulation.step()
        _record_state(path, index, simulation)
        if progress is not None and (index % 1000 == 0 or index == count):
            progress((index + 1) / (count + 1))
    return path


def whole_steps(seconds: float, time_step: float) -> int:
    """Steps in so many seconds; InputError for a time that is none, TooLargeError beyond MAX_STEPS."""
    if not 0 <= seconds < math.inf:
        raise InputError(f"seconds: expected a finite number, 0 or more; got {seconds}", "seconds")
    steps = seconds / time_step
    if steps > MAX_STEPS:
        raise TooLargeError(f"seconds: {seconds} s are {steps:.3g} steps; at most {MAX_STEPS} are recorded", "seconds")
    return math.floor(steps * (1 + 1e-12))  # 0.3 / 0.1 is just below 3


def _empty_path(settings: dict[str, Any], length: int) -> StonePath:
    def floats(*width: int) -> Floats:
        return np.empty((length, *width))

    def counts() -> NDArray[np.int64]:
        return np.empty(length, np.int64)

    return StonePath(
        settings=settings,
        step=counts(),
        time=floats(),
        position=floats(3),
        orientation=floats(4),
        velocity=floats(3),
        angular_velocity=floats(3),
        energy=floats(),
        asleep=np.empty(length, np.bool_),
        impacts=counts(),
        coarse=counts(),
        contacts=counts(),
        penetration=floats(),
        clearance=floats(),
    )


def _record_state(path: StonePath, index: int, simulation: Simulation) -> None:
    state, body = simulation.state, simulation.body
    touch = simulation.touch()
    path.step[index] = state.step
    path.time[index] = state.time
    path.position[index] = state.position
    path.orientation[index] = state.orientation
    path.velocity[index] = body.velocity(state)
    path.angular_velocity[index] = body.angular_velocity(state)
    path.energy[index] = simulation.energy()
    path.asleep[index] = state.asleep
    path.impacts[index] = state.impacts
    path.coarse[index] = state.coarse
    path.contacts[index] = touch.contacts
    path.penetration[index] = touch.penetration
    path.clearance[index] = touch.clearance


class RecordedTable(Protocol):
    """What is recorded: arrays, and the same as columns."""

    @property
    def settings(self) -> dict[str, Any]:
        """The scene's `simulation`, as JSON."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """One-dimensional arrays by name."""


def write(path: RecordedTable, file: pathlib.Path) -> None:
    """Write a path as its file's ending says, .csv, .json or .npz: all of it or nothing.

    Numbers in text read back as the same doubles. InputError for another ending, or a place that cannot be written to.
    """
    encode = _ENCODERS.get(file.suffix.lower())
    if encode is None:
        raise InputError(f"out: a path is written as {', '.join(_ENCODERS)}; got {file.name!r}", "out")
    write_whole(file, encode(path), "out")


def _csv(path: RecordedTable) -> bytes:
    columns = path.columns()
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    lists = [(column.astype(np.int64) if column.dtype == bool else column).tolist() for column in columns.values()]
    writer.writerows(zip(*lists, strict=True))
    return text.getvalue().encode()


def _json(path: RecordedTable) -> bytes:
    columns = {name: column.tolist() for name, column in path.columns().items()}
    document = {"version": 1, "simulation": path.settings, "columns": columns}
    return json.dumps(document, allow_nan=False).encode()


def _npz(path: RecordedTable) -> bytes:
    arrays = {name: value for name, value in vars(path).items() if name != "settings"}
    packed = io.BytesIO()
    np.savez_compressed(packed, allow_pickle=False, simulation=np.array(json.dumps(path.settings)), **arrays)
    return packed.getvalue()


_ENCODERS: dict[str, Callable[[RecordedTable], bytes]] = {".csv": _csv, ".json": _json, ".npz": _npz}

ENDINGS = tuple(ending.lstrip(".") for ending in _ENCODERS)
"""Of the files that `write` makes, without the dot."""
