"""How long something took, over and over: counts by duration, from which quantiles and metrics are made."""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

BOUNDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)
"""s, upper ends; longer ones are counted apart."""


class Histogram:
    """Of durations in seconds, since the engine started."""

    def __init__(self) -> None:
        """Empty."""
        self.counts = [0] * (len(BOUNDS) + 1)
        """By duration, each up to and with its bound; the last has none."""
        self.sum = 0.0
        """s, of all."""
        self.longest = 0.0
        """s."""

    @property
    def count(self) -> int:
        """Of all durations."""
        return sum(self.counts)

    def add(self, seconds: float) -> None:
        """Something took so long."""
        self.counts[bisect_left(BOUNDS, seconds)] += 1
        self.sum += seconds
        self.longest = max(self.longest, seconds)

    def as_json(self) -> dict[str, Any]:
        """`counts` are not cumulative, and have one more than `bounds`."""
        return {"bounds": BOUNDS, "counts": self.counts, "sum": self.sum, "longest": self.longest}
