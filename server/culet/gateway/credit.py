"""How much of the stream a viewer can take: a window of frames in flight, and the rate that comes of it."""

from __future__ import annotations

from collections import deque

WINDOW = 2
"""Frames in flight: one on its way while one is decoded and shown."""
IN_FLIGHT_SECONDS = 2.0
"""A frame not acknowledged for so long gives its credit back: a lost acknowledgement must not end the stream."""
FULL_RATE = 60.0
"""Frames per second that a viewer who is never short of credit is said to take."""
RATE_WINDOW_SECONDS = 1.0
HEADROOM = 1.5
"""A viewer short of credit is offered so much more than it took, so that it can be seen to recover."""


class Credit:
    """Frames sent and not yet acknowledged, oldest first. Times are seconds of any one clock."""

    def __init__(self) -> None:
        self._in_flight: deque[tuple[int, float]] = deque()
        self._acknowledged: deque[float] = deque()
        self._last_short = -float("inf")

    def available(self, now: float) -> bool:
        """Whether a frame may be sent. Asked only when there is one: `no` is remembered as being short of credit."""
        while self._in_flight and now - self._in_flight[0][1] >= IN_FLIGHT_SECONDS:
            self._in_flight.popleft()
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

    def clear(self) -> None:
        """Forget what is in flight: its numbers start anew."""
        self._in_flight.clear()

    def returns_at(self) -> float | None:
        """When the oldest frame in flight gives its credit back by itself."""
        return self._in_flight[0][1] + IN_FLIGHT_SECONDS if self._in_flight else None

    def rate(self, now: float) -> float:
        """Frames per second that this viewer can take."""
        while self._acknowledged and now - self._acknowledged[0] > RATE_WINDOW_SECONDS:
            self._acknowledged.popleft()
        if now - self._last_short > RATE_WINDOW_SECONDS:
            return FULL_RATE
        return min(FULL_RATE, max(1.0, HEADROOM * len(self._acknowledged) / RATE_WINDOW_SECONDS))
