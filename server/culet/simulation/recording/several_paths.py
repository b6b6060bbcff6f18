"""The ways that several stones take together, recorded step by step; `paths.write` writes them to a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.errors import TooLargeError
from culet.simulation.recording.paths import MAX_STEPS, Floats, Progress, by_axis, whole_steps
from culet.simulation.staged import world_of
from culet.simulation.world import World
from culet.stage import Stage


@dataclass(frozen=True, eq=False)
class SeveralPaths:
    """N states of S stones, the start first; the arrays' first axis is the step, the second the stone."""

    settings: dict[str, Any]
    """The scene's `simulation`, as JSON."""
    stone: NDArray[np.str_]
    """(S,), the stones' ids"""
    step: NDArray[np.int64]
    """(N,)"""
    time: Floats
    """(N,), s"""
    position: Floats
    """(N, S, 3), R"""
    orientation: Floats
    """(N, S, 4), unit quaternion w, x, y, z"""
    velocity: Floats
    """(N, S, 3), R/s"""
    angular_velocity: Floats
    """(N, S, 3), world axes, rad/s"""
    energy: Floats
    """(N,), of all stones together, carats R^2/s^2; its potential part is 0 with all centres 1 R above the floor"""
    asleep: NDArray[np.bool_]
    """(N, S)"""
    contacts: NDArray[np.int64]
    """(N, S), points at which the stone touches surfaces and other stones"""
    penetration: Floats
    """(N, S), how deep the deepest of them is, R"""
    clearance: Floats
    """(N, S), height of the stone's lowest vertex above the floor, R; negative: it is inside the floor"""

    def columns(self) -> dict[str, NDArray[Any]]:
        """One-dimensional arrays by name, with the axis after an underscore: a row for each step and stone."""
        count, stones = self.asleep.shape
        table: dict[str, NDArray[Any]] = {
            "stone": np.tile(self.stone, count),
            "step": np.repeat(self.step, stones),
            "time": np.repeat(self.time, stones),
        } | by_axis(self)
        table["energy"] = np.repeat(self.energy, stones)
        for name in ("asleep", "contacts", "penetration", "clearance"):
            table[name] = getattr(self, name).ravel()
        return table


def record_several(stage: Stage, seconds: float, progress: Progress | None = None) -> SeveralPaths:
    """Let the stage's stones move together for `seconds`, in whole steps.

    InputError for a time that is none, TooLargeError beyond MAX_STEPS of all stones together.
    """
    law = stage.scene.simulation
    count, stones = whole_steps(seconds, law.time_step), len(stage.shapes)
    if count * stones > MAX_STEPS:
        raise TooLargeError(
            f"seconds: {seconds} s are {count} steps of {stones} stones; at most {MAX_STEPS} are recorded", "seconds"
        )
    world = world_of(stage)
    paths = _empty(law.model_dump(mode="json"), [body.name for body in world.bodies], count + 1)
    for index in range(count + 1):
        if index:
            world.step()
        _record(paths, index, world)
        if progress is not None and (index % 100 == 0 or index == count):
            progress((index + 1) / (count + 1))
    return paths


def _empty(settings: dict[str, Any], names: list[str], length: int) -> SeveralPaths:
    shape = length, len(names)
    return SeveralPaths(
        settings=settings,
        stone=np.array(names),
        step=np.empty(length, np.int64),
        time=np.empty(length),
        position=np.empty((*shape, 3)),
        orientation=np.empty((*shape, 4)),
        velocity=np.empty((*shape, 3)),
        angular_velocity=np.empty((*shape, 3)),
        energy=np.empty(length),
        asleep=np.empty(shape, np.bool_),
        contacts=np.empty(shape, np.int64),
        penetration=np.empty(shape),
        clearance=np.empty(shape),
    )


def _record(paths: SeveralPaths, index: int, world: World) -> None:
    state = world.state
    paths.step[index], paths.time[index], paths.energy[index] = state.step, state.time, world.energy()
    for number, (body, touch) in enumerate(zip(state.bodies, world.touches(), strict=True)):
        paths.position[index, number] = body.position
        paths.orientation[index, number] = body.orientation
        paths.velocity[index, number] = body.velocity
        paths.angular_velocity[index, number] = body.spin
        paths.asleep[index, number] = body.asleep
        paths.contacts[index, number] = touch.contacts
        paths.penetration[index, number] = touch.penetration
        paths.clearance[index, number] = touch.clearance
