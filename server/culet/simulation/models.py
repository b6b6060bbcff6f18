"""The motion models by name: what the scene's `simulation.model` chooses from."""

from __future__ import annotations

from typing import Protocol

from culet.scene.model import Simulation as SimulationSettings
from culet.simulation import classic
from culet.simulation.body import RigidBody
from culet.simulation.state import RigidState


class MotionModel(Protocol):
    """A pure function from a state to the state one fixed step later; all that it remembers is in the state."""

    def __call__(self, state: RigidState, settings: SimulationSettings, body: RigidBody) -> RigidState: ...


MODELS: dict[str, MotionModel] = {"classic": classic.step}
