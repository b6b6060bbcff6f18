"""The turn of one picture at rest at being refined (rest_turns.py)."""

from __future__ import annotations

from dataclasses import dataclass

TURN_SECONDS = 8.0
"""s of the render thread: of a first turn."""
LONGEST = 8.0
"""A turn is over, too, when so many times as much has gone by on the clock: others' frames have most of the thread's
time, or its viewer takes none."""


@dataclass(eq=False)
class RestTurn:
    """Of one picture, as long as it shows the same. Mutable."""

    has: bool = False
    """It is refined, and holds memory for that."""
    seconds: float = TURN_SECONDS
    """s of the render thread that this turn, or else the next one, has while others wait."""
    spent: float = 0.0
    """s of the render thread in this turn."""
    since: float | None = None
    """s, steady clock: when the turn began, or else from when on it has been waited for; None: it is not yet."""

    def begin(self, now: float) -> None:
        """From now on it is refined."""
        self.has, self.spent, self.since = True, 0.0, now

    def end(self, now: float) -> None:
        """It is not refined until its next turn."""
        self.has, self.seconds, self.since = False, 2 * max(self.seconds, self.spent), now

    def leave(self) -> None:
        """It is not to be refined for now, and waits for nothing."""
        self.has, self.since = False, None

    def is_over(self, now: float) -> bool:
        """Whether it has had its time."""
        assert self.since is not None  # noqa: S101 - of a turn that has begun
        return self.spent >= self.seconds or now - self.since >= LONGEST * self.seconds

    def claim(self, now: float) -> float:
        """The least is next: who needs little, or has waited for long."""
        assert self.since is not None  # noqa: S101 - of one that is waited for
        return self.seconds - (now - self.since)
