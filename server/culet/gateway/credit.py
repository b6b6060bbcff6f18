"""How much of the stream a viewer can take: a window of frames in flight, and the rate that comes of it.

Credit comes back with an acknowledgement and in no other way. A WebSocket loses nothing: a frame that is not
acknowledged still lies in the connection or before a page that is busy, and another one would lie behind it. With the
connection goes the `Credit`.
"""

from __future__ import annotations

from collections import deque

WINDOW = 2
"""Frames in flight: one on its way while one is decoded and shown."""
FULL_RATE = 60.0
"""Frames per second that a viewer who is never short of credit is said to take."""
RATE_WINDOW_SECONDS = 1.0
HEADROOM = 1.5
"""A viewer short of credit is offered so much more than it took, so that it can be seen to recover."""
LEAST_RATE = 1.0
"""Frames per second that are made for a viewer on the slowest link: the next that goes out is at most so old."""
STALLED_SECONDS = 30.0
"""Nothing is rendered for a viewer that has acknowledged nothing for so long. At 10 kB/s a frame of 960 x 540 takes
6 s, a page that was stopped for ever."""


class Credit:
    """Frames sent and not yet acknowledged, oldest first. Times are seconds of any one clock."""

    def __init__(self) -> None:
        self._in_flight: deque[tuple[int, float]] = deque()
        self._acknowledged: deque[float] = deque()
        self._last_short = -float("inf")

    def available(self, now: float) -> bool:
        """Whether a frame may be sent. Asked only when there is one: `no` is remembered as being short of credit."""
        if len(self._in_flight) < WINDOW:
            return True
        self._last_short = now
        return False

    def take(self, sequence: int, now: float) -> None:
        """A frame goes out."""
        self._in_flight.append((sequence, now))

    def acknowledge(self, sequence: int, now: float) -> None:
        """A frame was shown, and so those sent before it are done with; an unknown number is ignored."""
        if any(sent == sequence for sent, _ in self._in_flight):
            while self._in_flight.popleft()[0] != sequence:
                pass
            self._acknowledged.append(now)

    def stalled(self, now: float) -> bool:
        """Whether the viewer owes an acknowledgement for longer than any link takes."""
        return bool(self._in_flight) and now - self._in_flight[0][1] >= STALLED_SECONDS

    def rate(self, now: float) -> float:
        """Frames per second that this viewer can take."""
        while self._acknowledged and now - self._acknowledged[0] > RATE_WINDOW_SECONDS:
            self._acknowledged.popleft()
        if self.stalled(now):
            return 0.0
        if now - self._last_short > RATE_WINDOW_SECONDS:
            return FULL_RATE
        return min(FULL_RATE, max(LEAST_RATE, HEADROOM * len(self._acknowledged) / RATE_WINDOW_SECONDS))
