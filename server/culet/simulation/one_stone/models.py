"""The motion models by name: what the scene's `simulation.model` chooses from."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from culet.simulation.one_stone import classic, rigid
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import RigidState, Touch
from culet.simulation.solver.library import library


class MotionModel(NamedTuple):
    """Pure functions: all that a model remembers is in the state."""

    step: Callable[[RigidState, SimulationSettings, RigidBody], RigidState]
    """The state one fixed step later."""
    touch: Callable[[RigidState, RigidBody], Touch]
    """How the state meets the surfaces."""
    require: Callable[[], object]
    """SolverUnavailableError if something is missing that a step needs."""


MODELS: dict[str, MotionModel] = {
    "rigid": MotionModel(rigid.step, rigid.touch, library),
    "classic": MotionModel(classic.step, classic.touch, lambda: None),
}
