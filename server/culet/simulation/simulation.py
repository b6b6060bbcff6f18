"""A stone in motion: the current state, the one before, and the way from one to the next."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from culet.errors import InputError
from culet.geometry.stone import Stone
from culet.scene.model import Simulation as SimulationSettings
from culet.simulation.body import RigidBody
from culet.simulation.impulses import impulse_at
from culet.simulation.models import MODELS
from culet.simulation.motion import Motion, speed
from culet.simulation.rotation import normalised, slerp
from culet.simulation.snapshot import read_snapshot, write_snapshot
from culet.simulation.state import Quaternion, RigidState, Touch, Triple
from culet.simulation.surfaces import FLOOR, Surface

MAX_SPEED = 1e4
"""R/s. Of any point of a stone after a push; the scene's own start may be faster."""


class Simulation:
    """Advances in fixed steps of `settings.time_step`; the same settings, stone and start give the same bits.

    It knows nothing of real time: `FixedStepClock` says how many steps are due, `interpolated` what to draw meanwhile.
    """

    def __init__(
        self,
        settings: SimulationSettings,
        stone: Stone,
        start_position: Triple,
        start_orientation: Quaternion,
        surfaces: tuple[Surface, ...] = (FLOOR,),
    ) -> None:
        """At the start, with the settings' `velocity` and `spin`; InputError if the start is no pose.

        `surfaces` stop the stone (`surfaces_of` a scene); the model `classic` knows the floor alone.
        """
        if not all(math.isfinite(c) for c in (*start_position, *start_orientation)):
            raise InputError(f"a start is finite; got {start_position}, {start_orientation}", "start")
        if not any(start_orientation):
            raise InputError("a quaternion of length 0 is no orientation", "start_orientation")
        self.settings = settings
        self.body = RigidBody.of(settings, stone, surfaces)
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
            self.state = self._model.step(state, self.settings, self.body)

    def push(self, impulse: Triple, point: Triple) -> None:
        """Strike the stone at a point of the world (R) with an impulse (mass R/s), and wake it.

        InputError if one of them is not finite, or the stone would be faster than a scene can ask for.
        """
        if not all(math.isfinite(c) for c in (*impulse, *point)):
            raise InputError(f"a push is finite; got {impulse} at {point}", "impulse")
        state = self.state
        motion = Motion(state.position, state.orientation, state.momentum, state.angular_momentum)
        x, y, z = (a - b for a, b in zip(point, state.position, strict=True))
        pushed = impulse_at(motion, (x, y, z), impulse)
        if speed(pushed, self.body) > MAX_SPEED:
            raise InputError(f"a push makes the stone move at {MAX_SPEED:g} R/s at most; got {impulse}", "impulse")
        self.state = replace(state, momentum=pushed.momentum, angular_momentum=pushed.angular_momentum, asleep=False)

    def surround(self, surfaces: tuple[Surface, ...]) -> None:
        """Put other surfaces about the stone; one that sleeps wakes, in case they moved it."""
        if surfaces != self.body.surfaces:
            self.body = replace(self.body, surfaces=surfaces)
            self.state = replace(self.state, asleep=False)

    def touch(self) -> Touch:
        """How the current state meets the surfaces."""
        return self._model.touch(self.state, self.body)

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
        """Kinetic and potential energy of the current state, mass R^2/s^2; 0 at rest 1 R above the floor."""
        return self.body.energy(self.state, self.settings.gravity)

    def snapshot(self) -> dict[str, Any]:
        """Everything that the future depends on besides settings and stone, as JSON's types."""
        return write_snapshot(self.state, self.previous)

    def restore(self, snapshot: Any) -> None:  # noqa: ANN401 - whatever JSON held
        """Go on from a snapshot to the same bits; InputError, and nothing changed, if it is none."""
        self.state, self.previous = read_snapshot(snapshot)
