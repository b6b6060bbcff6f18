"""How long frames take to be acknowledged, beside the same link without a queue.

What is told of a link by delay is told before anything is lost, and whatever the link's rate is: a window that followed
the rate of what arrives would stay at one frame a round trip, which is just the rate that one frame in flight gives.
"""

from __future__ import annotations

from collections import deque
from enum import Enum, auto
from typing import NamedTuple

MEMORY_SECONDS = 10.0
"""For which the fastest acknowledgement counts: routes change, and a queue is empty now and then."""
PROMPT_SECONDS, PROMPT_SHARE = 0.03, 0.05
"""A frame that is later than expected by less than this, and that share of the fastest one, did not wait in a queue: a
page shows frames at steps of 17 ms, and decodes them in some 10 ms."""
LATE_SECONDS, LATE_SHARE = 0.07, 0.15
"""A frame that is later by more waited in one."""


class Lateness(Enum):
    """Of one acknowledgement."""

    PROMPT = auto()
    FAIR = auto()
    """Neither prompt nor late."""
    LATE = auto()


class _Delay(NamedTuple):
    at: float
    seconds: float
    size: int


class Delays:
    """Of one viewer. Times are seconds of any one clock, sizes bytes."""

    def __init__(self) -> None:
        self._recent: deque[_Delay] = deque()
        """The fastest, and of those after it the fastest, and so on."""

    @property
    def least(self) -> float:
        """Seconds of the fastest acknowledgement; 0 before the first one."""
        return self._recent[0].seconds if self._recent else 0.0

    def judge(self, seconds: float, size: int, now: float, *, alone: bool, bytes_per_second: float) -> Lateness:
        """A frame of that size was acknowledged after so many seconds, on a link that is thought to have that rate.

        A frame that was `alone` in flight did not wait for others: if it is late, the link is another one than before.
        """
        while self._recent and now - self._recent[0].at > MEMORY_SECONDS:
            self._recent.popleft()
        fastest = self._recent[0] if self._recent else _Delay(now, seconds, size)
        extra = seconds - fastest.seconds - max(0, size - fastest.size) / bytes_per_second
        late = extra > LATE_SECONDS + LATE_SHARE * fastest.seconds
        if late and alone:
            self._recent.clear()
        while self._recent and self._recent[-1].seconds >= seconds:
            self._recent.pop()
        self._recent.append(_Delay(now, seconds, size))
        if late:
            return Lateness.LATE
        return Lateness.PROMPT if extra < PROMPT_SECONDS + PROMPT_SHARE * fastest.seconds else Lateness.FAIR
