"""How often somebody may ask for something: a bucket that fills with time, and one such bucket for each client.

The bucket is kept as one time, that at which it would be full (the generic cell rate algorithm, ITU-T I.371 annex A).
It may be overdrawn once: a client that asks for something dear waits for it afterwards, so that nothing is too dear to
be had.
"""

from __future__ import annotations

from collections import OrderedDict

BURST_SECONDS = 2.0
"""A full bucket holds what comes in so long: a page that stood still for a moment sends what it kept back."""
FORGOTTEN_OVER = 4096
"""Clients that a `ClientBuckets` remembers, the last seen; a full bucket that is forgotten is the same as a new one."""


class Bucket:
    """What may be spent, at `rate` a second. Times are seconds of any one clock."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._full_at = -float("inf")

    def spend(self, cost: float, now: float) -> None:
        """Take out so much, whether or not it is there."""
        self._full_at = max(self._full_at, now) + cost / self._rate

    def overdrawn_for(self, now: float) -> float:
        """Seconds until there is something in it again; 0 if there is."""
        return max(0.0, self._full_at - BURST_SECONDS - now)

    def is_full(self, now: float) -> bool:
        """Whether nothing was spent of late."""
        return self._full_at <= now


class ClientBuckets:
    """A bucket for each client."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._buckets: OrderedDict[str, Bucket] = OrderedDict()

    def __len__(self) -> int:
        return len(self._buckets)

    def of(self, client: str, now: float) -> Bucket:
        """The client's bucket, which is the same as long as it is not full."""
        bucket = self._buckets.setdefault(client, Bucket(self._rate))
        self._buckets.move_to_end(client)
        while len(self._buckets) > FORGOTTEN_OVER:
            oldest, forgotten = next(iter(self._buckets.items()))
            if not forgotten.is_full(now):
                self._buckets.move_to_end(oldest)  # or who owes long would have all after it remembered
                break
            del self._buckets[oldest]
        return bucket
