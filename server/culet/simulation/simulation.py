"""A stone in motion: the current state, the one before, and the way from one to the next."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from culet.errors import InputError
from culet.geometry.stone import Stone
from culet.scene.model import Simulation as SimulationSettings
from culet.simulation.body import RigidBody
from culet.simulation.models import MODELS
from culet.simulation.rotation import normalised, slerp
from culet.simulation.snapshot import read_snapshot, write_snapshot
from culet.simulation.state import Quaternion, RigidState, Triple


class Simulation:
    """Advances in fixed steps of `settings.time_step`; the same settings, stone and start give the same bits.

    It knows nothing of real time: `FixedStepClock` says how many steps are due, `interpolated` what to draw meanwhile.
    """

    def __init__(
        self, settings: SimulationSettings, stone: Stone, start_position: Triple, start_orientation: Quaternion
    ) -> None:
        """At the start, with the settings' `velocity` and `spin`; InputError if the start is no pose."""
        if not all(math.isfinite(c) for c in (*start_position, *start_orientation)):
            raise InputError(f"a start is finite; got {start_position}, {start_orientation}", "start")
        if not any(start_orientation):
            raise InputError("a quaternion of length 0 is no orientation", "start_orientation")
        self.settings = settings
        self.body = RigidBody.of(settings, stone)
        self._model = MODELS[settings.model]
        orientation = start_orientation
        if abs(sum(c * c for c in orientation) - 1) > 1e-12:  # normalising again would change the last bit
            orientation = normalised(orientation)
        vx, vy, vz = settings.velocity
        self._start = RigidState(
            step=0,
            time=0.0,
            position=start_position,
            orientation=orientation,
            momentum=(vx * self.body.mass, vy * self.body.mass, vz * self.body.mass),
            angular_momentum=self.body.angular_momentum(orientation, settings.spin),
        )
        self.state = self.previous = self._start

    @property
    def settled(self) -> bool:
        """Whether nothing that `interpolated` gives will change any more."""
        return self.state.asleep and self.previous.asleep

    def step(self) -> None:
        """Advance by one fixed step; asleep, only time passes."""
        state = self.state
        self.previous = state
        if state.asleep:
            self.state = replace(state, step=state.step + 1, time=state.time + self.settings.time_step)
        else:
            self.state = self._model(state, self.settings, self.body)

    def reset(self) -> None:
        """Back to the start, step 0."""
        self.state = self.previous = self._start

    def interpolated(self, fraction: float) -> tuple[Triple, Quaternion]:
        """Position and orientation `fraction` (0 to 1) of the way from the previous state to the current one."""
        if not 0 <= fraction <= 1:
            raise InputError(f"a fraction of a step is between 0 and 1; got {fraction}", "fraction")
        start, end = self.previous, self.state
        orientation = slerp(start.orientation, end.orientation, fraction)
        if fraction == 1:  # a + (b - a) need not be b
            return end.position, orientation
        x, y, z = (a + (b - a) * fraction for a, b in zip(start.position, end.position, strict=True))
        return (x, y, z), orientation

    def energy(self) -> float:
        """Kinetic and potential energy of the current state, mass R^2/s^2; 0 at rest on the floor."""
        return self.body.energy(self.state, self.settings.gravity)

    def snapshot(self) -> dict[str, Any]:
        """Everything that the future depends on besides settings and stone, as JSON's types."""
        return write_snapshot(self.state, self.previous)

    def restore(self, snapshot: Any) -> None:  # noqa: ANN401 - whatever JSON held
        """Go on from a snapshot to the same bits; InputError, and nothing changed, if it is none."""
        self.state, self.previous = read_snapshot(snapshot)
