"""How the stones of a scene fall, for scripts, notebooks and the command line."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.places import check_place
from culet.scene import Scene
from culet.simulation.recording.paths import ENDINGS, Progress, StonePath, record, write
from culet.simulation.recording.several_paths import SeveralPaths, record_several
from culet.simulation.staged import dropped
from culet.sources import load_scene, load_stage
from culet.stage import Stage

Floats = NDArray[np.float64]
Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True, eq=False, repr=False)
class Motion:
    """N states of S stones, the start first. Lengths are in R, of which `millimetres` says the size."""

    scene: Scene
    """With the stones at their starts."""
    path: StonePath | SeveralPaths
    """What was recorded, as the solver of one stone or of several has it."""
    findings: tuple[str, ...] = ()
    """What was found in the mesh's file, repaired or left out, and which stones overlap, a sentence each."""

    @property
    def stones(self) -> tuple[str, ...]:
        """(S,), the stones' ids."""
        return tuple(stone.id for stone in self.scene.stones)

    @property
    def millimetres(self) -> float:
        """One R, mm."""
        return self.scene.millimetres

    @property
    def time(self) -> Floats:
        """(N,), s; the steps are `simulation.time_step` long."""
        return self.path.time

    @property
    def position(self) -> Floats:
        """(N, S, 3), R: the centres of mass; y is up, the floor is y = -1."""
        return self._by_stone(self.path.position)

    @property
    def orientation(self) -> Floats:
        """(N, S, 4), unit quaternions w, x, y, z."""
        return self._by_stone(self.path.orientation)

    @property
    def velocity(self) -> Floats:
        """(N, S, 3), R/s."""
        return self._by_stone(self.path.velocity)

    @property
    def angular_velocity(self) -> Floats:
        """(N, S, 3), world axes, rad/s."""
        return self._by_stone(self.path.angular_velocity)

    @property
    def clearance(self) -> Floats:
        """(N, S), height of the stone's lowest vertex above the floor, R; negative: it is inside the floor."""
        return self._by_stone(self.path.clearance)

    @property
    def penetration(self) -> Floats:
        """(N, S), how deep the stone is inside a surface or another stone, R."""
        return self._by_stone(self.path.penetration)

    @property
    def asleep(self) -> NDArray[np.bool_]:
        """(N, S), whether the stone has come to rest for good."""
        return self._by_stone(self.path.asleep)

    @property
    def energy(self) -> Floats:
        """(N,), of all stones together, mass R^2/s^2; its potential part is 0 with all centres 1 R above the floor."""
        return self.path.energy

    def scene_at(self, seconds: float) -> Scene:
        """The scene with its stones where they are at a time: the last state that is not later. InputError for a time
        that was not simulated."""
        if not 0 <= seconds <= self.time[-1] + self.scene.simulation.time_step:
            raise InputError(f"seconds: expected 0 to {self.time[-1]:g}, got {seconds:g}", "seconds")
        state = int(np.searchsorted(self.time, seconds * (1 + 1e-12), side="right")) - 1
        position, orientation = self.position[state].tolist(), self.orientation[state].tolist()
        return self.scene.moved(*((tuple(p), tuple(q)) for p, q in zip(position, orientation, strict=True)))

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write all that was recorded as .csv, .json or .npz, whole or not at all; returns the path.

        InputError for another ending, and for a place that cannot be written to.
        """
        place = Path(path)
        check_place(place, "path", ENDINGS)
        write(self.path, place)
        return place

    def _by_stone(self, recorded: NDArray[Number]) -> NDArray[Number]:
        return recorded if isinstance(self.path, SeveralPaths) else recorded[:, None]

    def __repr__(self) -> str:
        return f"<Motion of {', '.join(self.stones)}: {len(self.time)} states, {self.time[-1]:g} s>"


def simulate(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str] | None = None,
    seconds: float = 5.0,
    *,
    mesh: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Motion:
    """Let the stones of a scene fall.

    A stone that stands on the floor is lifted to y = 1.5 R first, several stones all together.

    Args:
        scene: as `load_scene` takes it: a preset's name, a mapping, a file, a Scene; without it the default scene.
        seconds: simulated time, s, 0 or more.
        mesh: file of a mesh (.obj .off .stl .ply .glb) or of a design (.asc .gem .gcs) that takes the place of the
            scene's stone.
        progress: called now and then with the part done, 0 to 1.

    Raises:
        InputError: for what cannot be used, such as a scene without stones; `field` names it.
        TooLargeError: for more than half a million steps of all stones together.
        NotFoundError: for a name that no preset has.
        SolverUnavailableError: where no solver is built and no C compiler there to build it.

    >>> motion = simulate("falling", 0.1)
    >>> motion.position.shape, motion.position[-1, 0].round(3).tolist()
    ((13, 1, 3), [-0.52, 1.601, 0.0])
    """
    findings: list[str] = []
    stage = load_stage(load_scene(scene), None if mesh is None else Path(mesh), None, findings.append)
    return simulate_stage(stage, seconds, progress=progress, findings=tuple(findings))


def simulate_stage(
    stage: Stage, seconds: float, *, progress: Progress | None = None, findings: tuple[str, ...] = ()
) -> Motion:
    """Let a stage's stones fall; as `simulate`."""
    lifted = dropped(stage)
    alone = len(stage.shapes) <= 1 and all(stone.scale == 1 for stone in stage.scene.stones)
    path = record(lifted, seconds, progress) if alone else record_several(lifted, seconds, progress)
    return Motion(lifted.scene, path, findings)
