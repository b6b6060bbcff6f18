"""A link, an engine that makes frames as it is told, and a viewer's credit, on a clock that only this file has."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field

from culet.gateway.viewers.credit import Credit

STEP = 0.002
"""s; of the clock."""
TELL_SECONDS = 0.25
"""s; between two demands."""
ASKED = 30.0
"""Frames per second."""


@dataclass(frozen=True)
class Shown:
    """A frame that was acknowledged. Times are in s."""

    number: int
    at: float
    latency: float
    """From when it was made to when it arrived."""
    queued: float
    """How much longer its acknowledgement took than the link without a queue needs for it."""
    size: int
    """Bytes."""


@dataclass
class SimulatedLink:
    """One viewer. Rates are bytes per second, sizes bytes, times s."""

    rate: Callable[[float], float]
    """By the time."""
    round_trip: float
    full: int = 50_000
    """Of a frame without limits."""
    least: int = 4_000
    made: float = 30.0
    """Frames per second that the engine can make."""
    jitter: float = 0.004
    """Of acknowledgements, at most."""
    random: random.Random = field(default_factory=lambda: random.Random(1))  # noqa: S311
    credit: Credit = field(default_factory=Credit)
    shown: list[Shown] = field(default_factory=list)
    in_flight: list[tuple[Shown, int]] = field(default_factory=list)
    """With the frames that were in flight when it went out."""
    made_last: int = 0
    """Number of the frame made last."""
    now: float = 0.0
    _free_at: float = 0.0
    _waiting: tuple[int, float, int] | None = None
    _due_at: float = 0.0
    _told_at: float = -1.0
    _told: tuple[float, int] = (60.0, 0)

    def run(self, seconds: float, *, engine: bool = True) -> None:
        """So much longer; without the engine, no new frames come."""
        end = self.now + seconds
        while self.now < end:
            self.now += STEP
            while self.in_flight and self.in_flight[0][0].at <= self.now:
                shown, _ = self.in_flight.pop(0)
                self.credit.acknowledge(shown.number, self.now)
                self.shown.append(shown)
            if self.now - self._told_at >= TELL_SECONDS:
                self._told_at = self.now
                self._told = self.credit.rate(self.now), self.credit.bytes_per_frame(ASKED, self.now)
            if engine and self.now >= self._due_at:
                self._make()
            self._send()

    def _make(self) -> None:
        rate, share = self._told
        pace = min(self.made, ASKED)
        self._due_at = max(self._due_at + 1 / min(pace, max(rate, 0.5)), self.now)
        room = share * ASKED / max(pace, 15)
        size = int(max(self.least, min(self.full, 0.95 * room)) * self.random.uniform(0.9, 1.1))
        self.made_last += 1
        self._waiting = self.made_last, self.now, size

    def come(self, number: int, size: int) -> None:
        """A frame that was made elsewhere; one that waits yet is forgotten."""
        self.made_last = number
        self._waiting = number, self.now, size

    def _send(self) -> None:
        if self._waiting is None or not self.credit.available(self._waiting[2], self.now):
            return
        number, made_at, size = self._waiting
        self._waiting = None
        self.credit.take(number, size, self.now)
        alone = size / self.rate(self.now)
        self._free_at = max(self._free_at, self.now + self.round_trip / 2) + alone
        back = self._free_at + self.round_trip / 2 + self.random.uniform(0, self.jitter)
        queued = self._free_at - self.now - self.round_trip / 2 - alone
        frame = Shown(number, back, self._free_at - made_at, queued, size)
        self.in_flight.append((frame, len(self.in_flight)))

    def since(self, time: float) -> list[Shown]:
        """Frames acknowledged since then."""
        return [shown for shown in self.shown if shown.at >= time]
