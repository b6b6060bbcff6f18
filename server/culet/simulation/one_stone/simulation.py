"""A stone in motion: the current state, the one before, and the way from one to the next."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Self

from culet.errors import InputError, SceneError
from culet.geometry.shape import Shape
from culet.simulation.one_stone.drop import drop_position
from culet.simulation.one_stone.impulses import impulse_at
from culet.simulation.one_stone.models import MODELS
from culet.simulation.one_stone.snapshot import read_snapshot, write_snapshot
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, speed
from culet.simulation.rigid_body.rotation import normalised, slerp
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, RigidState, Touch, Triple
from culet.simulation.rigid_body.surfaces import FLOOR, Surface, surfaces_of
from culet.stage import Stage

REST: Triple = (0.0, 0.0, 0.0)
MAX_SPEED = 1e4
"""R/s. Of any point of a stone after a push; the scene's own start may be faster."""


class Simulation:
    """Advances in fixed steps of `settings.time_step`; the same settings, stone and start give the same bits.

    It knows nothing of real time: `FixedStepClock` says how many steps are due, `interpolated` what to draw meanwhile.
    """

    def __init__(
        self,
        settings: SimulationSettings,
        shape: Shape,
        start_position: Triple,
        start_orientation: Quaternion,
        surfaces: tuple[Surface, ...] = (FLOOR,),
    ) -> None:
        """At the start, with the settings' `velocity` and `spin`; InputError if the start is no pose, and
        SolverUnavailableError if the model `rigid` has no solver.

        `surfaces` stop the stone (`surfaces_of` a scene); the model `classic` knows the floor alone.
        """
        if not all(math.isfinite(c) for c in (*start_position, *start_orientation)):
            raise InputError(f"a start is finite; got {start_position}, {start_orientation}", "start")
        if not any(start_orientation):
            raise InputError("a quaternion of length 0 is no orientation", "start_orientation")
        MODELS[settings.model].require()
        self.settings = settings
        self.body = RigidBody.of(settings, shape, surfaces)
        orientation = start_orientation
        if abs(sum(c * c for c in orientation) - 1) > 1e-12:  # normalising again would change the last bit
            orientation = normalised(orientation)
        self._start = _moving_at(settings, self.body, RigidState(0, 0.0, start_position, orientation, REST, REST))
        self.state = self.previous = self._start

    @classmethod
    def of(cls, stage: Stage) -> Self:
        """At the start of the stage's stone, between the surfaces of the scene. SceneError for none, for several, and
        for one of another scale than 1."""
        scene, stone = stage.scene, stage.scene.only_stone()
        if stone is None:
            raise SceneError("stones: a simulation needs a stone; the scene has none", "stones")
        if stone.scale != 1:
            raise SceneError(f"stones.0.scale: expected 1, got {stone.scale:g}; a world moves others", "stones.0.scale")
        (shape,) = stage.shapes
        settings = SimulationSettings.of(scene, stone, shape)
        return cls(settings, shape, stone.position, stone.orientation, surfaces_of(scene))

    @property
    def settled(self) -> bool:
        """Whether nothing that `interpolated` gives will change any more."""
        return self.state.asleep and self.previous.asleep

    @property
    def at_start(self) -> bool:
        """Whether nothing has moved the stone yet."""
        return self.state == self._start

    def prepare(self) -> None:
        """Compute what all steps need, so that the first takes no longer than the next."""
        _ = self.body.hull

    def step(self) -> None:
        """Advance by one fixed step; asleep, only time passes."""
        state = self.state
        self.previous = state
        if state.asleep:
            self.state = replace(state, step=state.step + 1, time=state.time + self.settings.time_step)
        else:
            self.state = self._next(state)

    def _next(self, state: RigidState) -> RigidState:
        return MODELS[self.settings.model].step(state, self.settings, self.body)

    def push(self, impulse: Triple, point: Triple) -> None:
        """Strike the stone at a point of the world (R) with an impulse (mass R/s), and wake it.

        InputError if one of them is not finite, or the stone would be faster than a scene can ask for.
        """
        if not all(math.isfinite(c) for c in (*impulse, *point)):
            raise InputError(f"a push is finite; got {impulse} at {point}", "impulse")
        state = self.state
        motion = BodyMotion(state.position, state.orientation, state.momentum, state.angular_momentum)
        x, y, z = (a - b for a, b in zip(point, state.position, strict=True))
        pushed = impulse_at(motion, (x, y, z), impulse)
        if speed(pushed, self.body) > MAX_SPEED:
            raise InputError(f"a push makes the stone move at {MAX_SPEED:g} R/s at most; got {impulse}", "impulse")
        self.state = replace(state, momentum=pushed.momentum, angular_momentum=pushed.angular_momentum, asleep=False)

    def adjust(self, settings: SimulationSettings) -> None:
        """Go on from the current state with other settings; any of them may differ, the model too.

        Pose and velocities stay as they are: with another mass or inertia the momenta follow. `velocity` and `spin` are
        of the start: they hold from the next `reset` on, or now if no step was taken. A stone that sleeps wakes just if
        its next step would move it. Deterministic: the same changes at the same steps give the same bits. Who counts
        the steps (`FixedStepClock`) must hear of another `time_step` too. InputError, and nothing changed, if the
        stone has no such inertia; SolverUnavailableError likewise if the model has no solver.
        """
        if settings == self.settings:
            return
        MODELS[settings.model].require()
        old, body = self.body, self.body
        if (settings.mass, settings.inertia) != (self.settings.mass, self.settings.inertia):
            body = RigidBody.of(settings, old.shape, old.surfaces)
        unmoved = self.at_start
        self.settings, self.body = settings, body
        self._start = _moving_at(settings, body, self._start)
        if unmoved:
            self.state = self.previous = self._start
            return
        if body is not old:
            velocity, omega = old.velocity(self.state), old.angular_velocity(self.state)
            self.state = _with_velocities(self.state, body, velocity, omega)
        self._wake_if_moved()

    def surround(self, surfaces: tuple[Surface, ...]) -> None:
        """Put other surfaces about the stone; one that sleeps wakes just if its next step would move it."""
        if surfaces != self.body.surfaces:
            self.body = replace(self.body, surfaces=surfaces)
            self._wake_if_moved()

    def _wake_if_moved(self) -> None:
        if not self.state.asleep:
            return
        awake = replace(self.state, asleep=False)
        if self._next(awake) != replace(self.state, step=awake.step + 1, time=awake.time + self.settings.time_step):
            self.state = awake

    def touch(self) -> Touch:
        """How the current state meets the surfaces."""
        return MODELS[self.settings.model].touch(self.state, self.body)

    def reset(self) -> None:
        """Back to the start, step 0."""
        self.state = self.previous = self._start

    def drop(self) -> None:
        """Back to the start, step 0; a stone that stands on the floor there is lifted first, so that it falls."""
        start = self._start
        position = drop_position(self.body.shape, start.position, start.orientation)
        self.state = self.previous = replace(start, position=position)

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


def _moving_at(settings: SimulationSettings, body: RigidBody, start: RigidState) -> RigidState:
    return _with_velocities(start, body, settings.velocity, settings.spin)


def _with_velocities(state: RigidState, body: RigidBody, velocity: Triple, omega: Triple) -> RigidState:
    x, y, z = velocity
    m = body.mass
    angular_momentum = body.angular_momentum(state.orientation, omega)
    return replace(state, momentum=(x * m, y * m, z * m), angular_momentum=angular_momentum)
