"""How much of the stream a viewer can take: a window of frames in flight, the rate that comes of it, and the bytes that
frames may have.

Credit comes back with an acknowledgement and in no other way. A WebSocket loses nothing: a frame that is not
acknowledged still lies in the connection or before a page that is busy, and another one would lie behind it. With the
connection goes the `Credit`.

The window is wide enough to keep the link busy and no wider: it grows while frames that have to wait for it are
acknowledged as fast as the fastest of the last ten seconds, and shrinks when they queue.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from culet.gateway.viewers.delays import Delays, Lateness
from culet.gateway.viewers.throughput import Throughput

FIRST_WINDOW = 1
"""Frames in flight before anything is known of a link."""
LARGEST_WINDOW = 12
"""Frames: 0.4 s at 30 a second, the round trip by way of a satellite."""
SHRINK = 0.8
"""Of the window, once a round trip while frames are late."""
QUEUE_SECONDS = 0.08
"""So long, besides the way there and back, all that is in flight may take the link: that is what a frame waits at most,
and on a link that has become ten times as slow, a second."""
FIRST_BYTES = 32_000
"""Of a frame for a viewer of whose link nothing is known: a second of the slowest link that is of use, 240 kbit/s.
A final picture at rest may have `FINAL_TIMES` (of engines' thrift) times as many."""
REST_SECONDS = 0.75
"""Of the link for a picture at rest: it is looked at for long, but whatever comes next comes behind it. The
final one, which nothing follows by itself, may take `FINAL_TIMES` times as long if it would be coarse otherwise, but
not to have less loss than those before it."""
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


class _Sent(NamedTuple):
    sequence: int
    at: float
    size: int
    alone: bool
    """Nothing else was in flight."""


class Credit:
    """Frames sent and not yet acknowledged, oldest first. Times are seconds of any one clock, sizes bytes."""

    def __init__(self) -> None:
        self._in_flight: deque[_Sent] = deque()
        self._acknowledged: deque[float] = deque()
        self._last_short = -float("inf")
        self._last_size = 0
        """Of the frame that had to wait last, or was sent after it."""
        self._short = False
        """A frame has had to wait for the window since it grew last."""
        self._window = float(FIRST_WINDOW)
        self._met_queue = False
        """Frames have been late: the window grows slowly from then on."""
        self._shrunk_at = -float("inf")
        self._delays = Delays()
        self._throughput = Throughput()

    @property
    def window(self) -> int:
        """Frames that may be in flight."""
        return int(self._window)

    def available(self, size: int, now: float) -> bool:
        """Whether a frame of that size may be sent. Asked only when there is one: `no` is remembered as being short of
        credit."""
        if not self._in_flight:
            return True
        if len(self._in_flight) < self.window and self._fits(size, now):
            return True
        self._last_short, self._short, self._last_size = now, True, size
        return False

    def _fits(self, size: int, now: float) -> bool:
        """Whether all that is in flight, and a frame of that size behind it, make no long queue."""
        rate = self.bytes_per_second(now)
        seconds = self._delays.least + QUEUE_SECONDS
        return rate is None or sum(sent.size for sent in self._in_flight) + size <= rate * seconds

    def was_short(self, now: float) -> bool:
        """Whether a frame has had to wait lately."""
        return now - self._last_short <= RATE_WINDOW_SECONDS

    def bytes_per_second(self, now: float) -> float | None:
        """What the link carries: no more than what would have brought an acknowledgement that is missing."""
        rate = self._throughput.bytes_per_second
        if rate is None or not self._in_flight:
            return rate
        oldest = self._in_flight[0]
        return min(rate, oldest.size / max(now - oldest.at - self._delays.least, 1e-6))

    def take(self, sequence: int, size: int, now: float) -> None:
        """A frame goes out."""
        self._last_size = size
        self._in_flight.append(_Sent(sequence, now, size, alone=not self._in_flight))

    def acknowledge(self, sequence: int, now: float) -> None:
        """A frame was shown, and so those sent before it are done with; an unknown number is ignored."""
        if all(sent.sequence != sequence for sent in self._in_flight):
            return
        size = 0
        while True:
            sent = self._in_flight.popleft()
            size += sent.size
            if sent.sequence == sequence:
                break
        self._acknowledged.append(now)
        self._learn(sent._replace(size=size), now)

    def _learn(self, sent: _Sent, now: float) -> None:
        rate = self._throughput.bytes_per_second or float("inf")
        delay = now - sent.at
        lateness = self._delays.judge(delay, sent.size, now, alone=sent.alone, bytes_per_second=rate)
        least = self._delays.least
        self._forget(now)
        self._throughput.acknowledged(sent.size, sent.at, now, lateness, least, self._taken_rate)
        if lateness is Lateness.LATE:
            self._met_queue = True
            if now - self._shrunk_at > max(delay, least):
                self._window, self._shrunk_at = max(1.0, SHRINK * self._window), now
        elif lateness is Lateness.PROMPT and self._short:
            self._window = min(LARGEST_WINDOW, self._window + (1 / self._window if self._met_queue else 1))
            self._short = False

    def stalled(self, now: float) -> bool:
        """Whether the viewer owes an acknowledgement for longer than any link takes."""
        return bool(self._in_flight) and now - self._in_flight[0].at >= STALLED_SECONDS

    def rate(self, now: float) -> float:
        """Frames per second that this viewer can take."""
        self._forget(now)
        if self.stalled(now):
            return 0.0
        if not self.was_short(now):
            return FULL_RATE
        carried = (self.bytes_per_second(now) or 0.0) / max(1, self._last_size)
        return min(FULL_RATE, max(LEAST_RATE, HEADROOM * self._taken_rate, carried))

    def bytes_per_frame(self, frames_per_second: float, now: float) -> int:
        """That a frame may have if they come at that rate."""
        rate = self.bytes_per_second(now)
        return FIRST_BYTES if rate is None else max(1, int(rate / frames_per_second))

    def bytes_at_rest(self, now: float) -> int:
        """That a picture at rest may have."""
        rate = self.bytes_per_second(now)
        return FIRST_BYTES if rate is None else max(1, int(rate * REST_SECONDS))

    def _forget(self, now: float) -> None:
        while self._acknowledged and now - self._acknowledged[0] > RATE_WINDOW_SECONDS:
            self._acknowledged.popleft()

    @property
    def _taken_rate(self) -> float:
        """Frames per second that were acknowledged lately."""
        return len(self._acknowledged) / RATE_WINDOW_SECONDS
