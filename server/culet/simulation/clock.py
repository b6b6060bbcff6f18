"""Real time, cut into fixed steps: how often a picture is drawn has no influence on how the stone moves.

After Fiedler, "Fix Your Timestep!" (2004): time that has passed is put by, taken out in whole steps, and what is left
over says how far between the last two states the picture is.
"""

from __future__ import annotations

import math

from culet.errors import InputError

MAX_CATCH_UP = 0.25
"""s. Time beyond this in one call is dropped: after a stall the stone goes on where it was, rather than a long run of
steps stalling the next frame as well (the "spiral of death"). Larger: jumps after a stall; smaller than a slow frame:
slow motion."""

MOST_WORK = 0.02
"""s of the processor for one call's steps; about what a frame has. The step during which they run out is finished."""

WORK_SHARE = 0.5
"""Of the time that passes, which steps may take on the average. 1: one session's stone can keep all others waiting."""

SHARED_WORK = 0.3
"""Of a session's share of the time, likewise, beside others: where they are so many that all stones move slower, frames
are what the time is for. Two sessions have three times as much as a brilliant in contact takes."""

LEAST_WORK = 0.25
"""Of MOST_WORK, for one call however many share the time: a step or two in contact."""


PACE_SECONDS = 1.0
"""Over which the pace is averaged: one stall of a quarter of a second is no slow motion."""

NOTICED = 0.1
"""Slower by less nobody sees, nor is it worth saying."""


class FixedStepClock:
    """Counts steps due. `dropped` is the time, in seconds, that was given up so far."""

    def __init__(self, time_step: float) -> None:
        """A clock for steps of `time_step` seconds, with no time put by."""
        if not 0 < time_step < math.inf:
            raise InputError(f"a time step is a positive number of seconds; got {time_step}", "time_step")
        self.time_step = time_step
        self.dropped = 0.0
        self._put_by = 0.0

    @property
    def fraction(self) -> float:
        """Where the present is between the previous state (0) and the current one (1)."""
        return min(self._put_by / self.time_step, 1.0)

    def advance(self, elapsed: float) -> int:
        """Let `elapsed` seconds of real time pass; the number of steps to take now.

        At most MAX_CATCH_UP and what was put by before, so never more than MAX_CATCH_UP / time_step + 1 steps.
        """
        if not 0 <= elapsed < math.inf:
            raise InputError(f"time passes forward by a finite number of seconds; got {elapsed}", "elapsed")
        taken = min(elapsed, MAX_CATCH_UP)
        self.dropped += elapsed - taken
        self._put_by += taken
        steps = int(self._put_by / self.time_step)
        self._put_by = max(self._put_by - steps * self.time_step, 0.0)
        return steps

    def drop(self, steps: int) -> None:
        """Give up so many of the steps that were due."""
        self.dropped += steps * self.time_step

    def lose(self, seconds: float) -> None:
        """Let so much real time pass unused."""
        self.dropped += seconds

    def restart(self) -> None:
        """Forget the time put by, as after a pause."""
        self._put_by = 0.0


class Allowance:
    """Processor time that steps may take: what is too much for it is simulated in slow motion.

    It has no influence on how the stone moves from one step to the next, only on when the steps are taken.
    """

    def __init__(self) -> None:
        """Full."""
        self._left = MOST_WORK

    @property
    def spent(self) -> bool:
        """Whether no further step may be begun now."""
        return self._left <= 0

    def grow(self, elapsed: float, share: float = 1.0) -> None:
        """Let `elapsed` seconds of real time pass, of which others leave that share."""
        part = WORK_SHARE if share >= 1 else min(WORK_SHARE, SHARED_WORK * share)
        self._left = min(self._left + part * elapsed, MOST_WORK * max(share, LEAST_WORK))

    def spend(self, seconds: float) -> None:
        """A step has taken so many seconds of the processor, maybe more than are left: later steps wait for that."""
        self._left -= seconds


class Pace:
    """How fast a simulation goes, beside real time."""

    def __init__(self) -> None:
        """In real time."""
        self.seconds = 0.0
        """Of real time that have passed while something moved."""
        self.dropped = 0.0
        """Of these, that were given up."""
        self.lately = 1.0
        """Part of real time, averaged over PACE_SECONDS."""
        self._dropped_before = 0.0

    @property
    def slow(self) -> bool:
        """Whether one who looks on can notice that it is slower than real time."""
        return self.lately < 1 - NOTICED

    def passed(self, elapsed: float, dropped: float) -> None:
        """So many seconds of real time have passed, and a clock has dropped so many in all (a new one begins at 0)."""
        lost = dropped - self._dropped_before if dropped >= self._dropped_before else dropped
        self._dropped_before = dropped
        self.seconds += elapsed
        self.dropped += lost
        if elapsed > 0:
            weight = -math.expm1(-elapsed / PACE_SECONDS)
            self.lately += weight * (max(0.0, 1 - lost / elapsed) - self.lately)
