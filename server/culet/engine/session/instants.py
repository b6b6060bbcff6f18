"""What a motion writes down of its latest steps, and what of that is seen at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from culet.scene.fields import Pose
from culet.simulation.bodies import WorldState


@dataclass(frozen=True, eq=False)
class Lease:
    """That somebody looks on, and so time goes on."""

    since: float
    """s, steady clock: when the first one looked on after a pause."""
    until: float
    """s, steady clock: as long as one look keeps time going."""
    lost: float
    """s since then, during which nobody looked on: they are not made up for."""
    share: float
    """Of the time that a session can have beside others."""


@dataclass(frozen=True, eq=False)
class Instant:
    """The latest states, and where between them time was when they were written down."""

    names: tuple[str, ...]
    """Of the stones, in the order of the states."""
    previous: WorldState
    state: WorldState
    settled: bool
    """All stones sleep in both."""
    fraction: float
    """From the previous state (0) to the later one (1)."""
    time_step: float
    """s"""
    at: float
    """s, steady clock, without what was lost: when the fraction was that."""
    lease: Lease | None
    """By which time goes on from there; None if it stands."""

    def fraction_at(self, now: float, lease: Lease | None) -> float:
        """Where between the states time is at `now`, by the lease that holds then; time waits at the later state."""
        if self.lease is None or lease is None or self.lease.since != lease.since:
            return self.fraction
        ahead = min(now, lease.until) - lease.lost - self.at
        return self.fraction if ahead <= 0 else min(self.fraction + ahead / self.time_step, 1.0)


@dataclass(frozen=True)
class PosesSeen:
    """Where the stones are at a time."""

    poses: Mapping[str, Pose]
    """By the ids of the stones."""
    time: float
    """s of simulation."""
    moving: bool
    """Whether time would change the poses."""
