"""A session's stone in time: whether it falls, in fixed steps that follow a steady clock, and where it is shown."""

from __future__ import annotations

from collections.abc import Callable
from time import thread_time
from typing import Any

from culet.engine.session.snapshot import LARGEST_FRACTION
from culet.errors import InputError
from culet.scene import Scene
from culet.simulation import Allowance, FixedStepClock, Pace, Simulation, surfaces_of
from culet.simulation.settings import SimulationSettings
from culet.simulation.state import Quaternion, Triple
from culet.stage import Stage


class Motion:
    """Mutable. A scene without a stone has a motion too, in which nothing ever moves."""

    def __init__(self, stage: Stage, *, timer: Callable[[], float] = thread_time) -> None:
        """A stone at rest where the scene has it. `timer` says how many seconds of the processor were taken."""
        self.falling = False
        """Time goes on for the stone, should it not sleep."""
        self.pace = Pace()
        self._timer = timer
        self._allowance = Allowance()
        self._advanced_at: float | None = None
        """s, steady clock: up to when time was simulated. None: time begins with the next look at the clock."""
        self.simulation = _simulation(stage)
        """None without a stone."""
        self.clock = _clock(stage.scene.simulation.time_step)

    def restore(self, simulation: dict[str, Any] | None, fraction: float, *, falling: bool) -> None:
        """Go on from what another engine's `simulation` and clock were; InputError if that is no snapshot."""
        self.clock = _clock(self.clock.time_step, fraction)
        self.falling = falling and self.simulation is not None
        if self.simulation is not None and simulation is not None:
            self.simulation.restore(simulation)

    @property
    def moving(self) -> bool:
        """Whether time would change what is shown."""
        return self.falling and self.simulation is not None and not self.asleep

    @property
    def asleep(self) -> bool:
        """Whether the stone has come to rest for good, unless somebody changes something."""
        return self.simulation is not None and self.simulation.settled

    @property
    def fraction(self) -> float:
        """How far the shown pose is from the last state but one to the last."""
        return self.clock.fraction

    @property
    def time(self) -> float:
        """s of simulation, of the shown pose."""
        if self.simulation is None:
            return 0.0
        before, after = self.simulation.previous.time, self.simulation.state.time
        return before + (after - before) * self.fraction

    def pose(self) -> tuple[Triple, Quaternion] | None:
        """Position and orientation of the stone as shown."""
        return None if self.simulation is None else self.simulation.interpolated(self.fraction)

    def snapshot(self) -> dict[str, Any] | None:
        """What the scene and `fraction` do not say."""
        return None if self.simulation is None else self.simulation.snapshot()

    def follow(self, scene: Scene) -> None:
        """Go on from where the stone is by the scene's settings; InputError, and nothing changed, if it cannot."""
        was_moving = self.moving
        if self.simulation is not None:
            self.simulation.adjust(SimulationSettings.of(scene, scene.stones[0], self.simulation.body.shape))
            self.simulation.surround(surfaces_of(scene))
        if scene.simulation.time_step != self.clock.time_step:
            self.clock = _clock(scene.simulation.time_step, self.fraction)
        if not was_moving:
            self.pause()  # the time that it rested is not made up for

    def place(self, stage: Stage) -> None:
        """Put a stone, or none, to where the scene has it; it falls on from there if one was falling."""
        self.simulation = _simulation(stage)
        self.pause()
        self.clock.restart()

    def reset(self) -> None:
        """Put the stone back to where it started, and stop it."""
        if self.simulation is not None:
            self.simulation.reset()
        self.stop()

    def set_falling(self, falling: bool) -> None:
        """Start or pause free fall; InputError without a stone."""
        simulation = self._stone("fall")
        if falling:
            simulation.prepare()
        self.falling = falling
        self.pause()

    def toggle_fall(self) -> None:
        """Start or pause free fall. A stone that sleeps, or has not moved yet, is dropped from where the scene has it,
        and from above there if it stands on the floor. InputError without a stone."""
        simulation, was_falling = self._stone("fall"), self.falling
        if self.asleep or (simulation.at_start and not was_falling):
            self.stop()
            simulation.drop()
            was_falling = False
        self.set_falling(not was_falling)

    def push(self, point: Triple, velocity: Triple) -> None:
        """Strike the stone at a point of the world (R) so that its centre's velocity changes by `velocity` (R/s), and
        let time go on. InputError without a stone, or if the blow is too strong."""
        simulation, was_moving = self._stone("be pushed"), self.moving
        a, b, c = (component * simulation.body.mass for component in velocity)
        simulation.push((a, b, c), point)
        self.falling = True
        if not was_moving:
            self.pause()

    def advance(self, now: float, share: float = 1.0) -> bool:
        """Simulate up to `now`, in seconds of a steady clock, in fixed steps; whether there was anything to move.

        Steps may take their part of the `share` of the time that the session can have beside others. Steps that take
        too long are given up (`Allowance`). If one fails, the stone stops, and the error is raised.
        """
        if self.simulation is None or not self.moving:
            return False
        elapsed = 0.0 if self._advanced_at is None else max(now - self._advanced_at, 0.0)
        self._advanced_at = now
        try:
            self._step(self.simulation, elapsed, share)
        except Exception:
            self.stop()
            raise
        return True

    def pause(self) -> None:
        """Time that passes until the next look at the clock is not made up for, nor is any lost."""
        self._advanced_at = None

    def stop(self) -> None:
        """Nothing falls any more; what was put by of a step is forgotten."""
        self.falling = False
        self.pause()
        self.clock.restart()

    def _step(self, simulation: Simulation, elapsed: float, share: float) -> None:
        self._allowance.grow(elapsed, share)
        due = self.clock.advance(elapsed)
        for taken in range(due):
            if self._allowance.spent:
                self.clock.drop(due - taken)
                break
            begun = self._timer()
            simulation.step()
            self._allowance.spend(self._timer() - begun)
        self.pace.passed(elapsed, self.clock.dropped)

    def _stone(self, verb: str) -> Simulation:
        if self.simulation is None:
            raise InputError(f"expected a scene with a stone, got none: nothing can {verb}")
        return self.simulation


def _simulation(stage: Stage) -> Simulation | None:
    return Simulation.of(stage) if stage.shapes else None


def _clock(time_step: float, fraction: float = 0.0) -> FixedStepClock:
    """A clock for steps of `time_step` seconds that is so far between two of them."""
    clock = FixedStepClock(time_step)
    clock.advance(min(fraction, LARGEST_FRACTION) * time_step)
    return clock
