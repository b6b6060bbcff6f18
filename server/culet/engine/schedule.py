"""What the one render thread does next: pure choices from what is due.

A frame whose time has come goes first, the one begun longest ago before others, so that sessions share fairly. After
every frame, one band of background work (a refinement or a still) gets its turn, so that no still starves.
"""

from __future__ import annotations

from collections.abc import Iterable

from culet.engine.live import LivePicture
from culet.engine.still import Still


def next_frame(pictures: Iterable[LivePicture], now: float) -> LivePicture | None:
    """The picture whose frame is due and was begun longest ago."""
    due = [picture for picture in pictures if (time := picture.due_at()) is not None and time <= now]
    return min(due, key=lambda picture: picture.begun_at, default=None)


def next_background(pictures: Iterable[LivePicture], still: Still | None) -> LivePicture | Still | None:
    """The refinement or still that had its last turn longest ago."""
    waiting: list[LivePicture | Still] = [picture for picture in pictures if picture.wants_refinement()]
    if still is not None:
        waiting.append(still)
    return min(waiting, key=lambda work: work.served_at, default=None)


def next_repeat(pictures: Iterable[LivePicture], now: float) -> LivePicture | None:
    """A picture at rest whose frame is to be sent again."""
    for picture in pictures:
        time = picture.repeat_at()
        if time is not None and time <= now:
            return picture
    return None


def idle_seconds(pictures: Iterable[LivePicture], now: float) -> float | None:
    """How long there is nothing to do unless something changes; None: for ever."""
    times = [time for picture in pictures for time in (picture.due_at(), picture.repeat_at()) if time is not None]
    return max(min(times) - now, 0.0) if times else None
