"""Bytes a second that a viewer's link carries, as far as its acknowledgements tell.

Frames that follow each other without a gap arrive as fast as the link carries them: their bytes over the time between
their acknowledgements are its rate. Frames with gaps between them tell only that the link carries no less than they
have. So the rate falls to what arrived without a gap, to a little less if frames are late, and rises while frames that
use it are prompt: slowly about the rate that was measured last, fast once much more than that has arrived.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from culet.gateway.viewers.delays import Lateness

MARGIN = 0.9
"""Of what the link was measured to carry: with less than all of it a queue gets shorter."""
STEP_SECONDS = 0.2
"""Between two changes, or one round trip if that is longer: what the last one led to has to be seen."""
SLOW_GROWTH, FAST_GROWTH = 1.04, 1.25
"""Of one step, with and without a measured rate."""
BEYOND = 1.3
"""So many times that rate are tried: frames seldom have just the bytes that they may have."""
SURPASSED = 1.15
"""If so many times that rate arrives, the link has become another."""
MET_SECONDS = 10.0
"""For which that rate counts, if it is not measured again."""
DELIVERY_SECONDS = 0.5
"""Over which what arrives is counted."""
USED = 0.4
"""A frame of less than this part of what the rate gives it says nothing of what a larger one would meet."""
SLOWEST_FRAMES = 15.0
"""Frames per second for which the rate is shared out at least."""
RUN_SECONDS = 0.6
"""Of frames without a gap that are measured together."""
SURE_FRAMES, SURE_SECONDS = 4, 0.1
"""So many of them, in so long a time, are sure to tell the link's rate."""
LATE_IN_A_ROW = 2
"""One late frame may be the page's doing."""
LEAST, MOST = 4e3, 100e6
"""Bytes a second: a frame of the smallest kind each second, and more than any picture has."""


class _Arrival(NamedTuple):
    at: float
    size: int


class Throughput:
    """Of one viewer. Times are seconds of any one clock."""

    def __init__(self) -> None:
        self.bytes_per_second: float | None = None
        """Not known before the first acknowledgement."""
        self._met: float | None = None
        """Bytes per second that were measured last."""
        self._met_at = -float("inf")
        self._arrivals: deque[_Arrival] = deque()
        """Of DELIVERY_SECONDS."""
        self._changed_at = -float("inf")
        self._late = 0
        """Late frames in a row."""
        self._run: deque[_Arrival] = deque()
        """Frames that followed each other without a gap, the last ones; of the first one only the time counts."""

    def acknowledged(
        self, size: int, sent_at: float, now: float, lateness: Lateness, least_delay: float, frames_per_second: float
    ) -> None:
        """A frame of that size was acknowledged; frames come at that rate lately."""
        if self.bytes_per_second is None:
            self.bytes_per_second = self._bounded(size / max(now - sent_at, 1e-6))
            self._changed_at = now
            self._run.append(_Arrival(now, size))
            return
        self._follow(size, sent_at, now, least_delay)
        self._late = self._late + 1 if lateness is Lateness.LATE else 0
        self._arrivals.append(_Arrival(now, size))
        while now - self._arrivals[0].at > DELIVERY_SECONDS:
            self._arrivals.popleft()
        if now - self._changed_at < max(STEP_SECONDS, least_delay):
            return
        if self._late >= LATE_IN_A_ROW:
            self._met, self._met_at = self._measured() or size / max(now - sent_at, 1e-6), now
            self._set(min(self.bytes_per_second, MARGIN * self._met), now)
        elif self._is_sure() and (measured := self._measured()) is not None:  # let no queue grow
            self._met, self._met_at = measured, now
            self._set(min(self.bytes_per_second, measured), now)
        elif lateness is Lateness.PROMPT and self._uses(size, frames_per_second):
            self._grow(now)

    def _grow(self, now: float) -> None:
        assert self.bytes_per_second is not None  # noqa: S101 - there was an acknowledgement
        delivered = sum(arrival.size for arrival in self._arrivals) / DELIVERY_SECONDS
        if self._met is not None and (delivered > SURPASSED * self._met or now - self._met_at > MET_SECONDS):
            self._met = None
        if self._met is None:
            self._set(self.bytes_per_second * FAST_GROWTH, now)
        else:
            self._set(max(self.bytes_per_second, min(self.bytes_per_second * SLOW_GROWTH, BEYOND * self._met)), now)

    def _uses(self, size: int, frames_per_second: float) -> bool:
        assert self.bytes_per_second is not None  # noqa: S101 - there was an acknowledgement
        return size * max(SLOWEST_FRAMES, frames_per_second) >= USED * self.bytes_per_second

    def _follow(self, size: int, sent_at: float, now: float, least_delay: float) -> None:
        if sent_at + least_delay > self._run[-1].at:  # the link was empty before it came
            self._run.clear()
            self._run.append(_Arrival(now, 0))
            return
        self._run.append(_Arrival(now, size))
        while len(self._run) > 2 and now - self._run[1].at > RUN_SECONDS:
            self._run.popleft()

    def _is_sure(self) -> bool:
        """Whether frames followed each other for so long that their rate is the link's."""
        return len(self._run) > SURE_FRAMES and self._run[-1].at - self._run[0].at >= SURE_SECONDS

    def _measured(self) -> float | None:
        """Bytes per second of the frames that followed each other; None if none did."""
        seconds = self._run[-1].at - self._run[0].at
        return sum(arrival.size for arrival in list(self._run)[1:]) / seconds if seconds > 0 else None

    def _set(self, bytes_per_second: float, now: float) -> None:
        self.bytes_per_second, self._changed_at = self._bounded(bytes_per_second), now

    def _bounded(self, bytes_per_second: float) -> float:
        return min(MOST, max(LEAST, bytes_per_second))
