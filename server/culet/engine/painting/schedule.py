"""What the one render thread does next: pure choices from what is due.

Every session has its share of the thread's time (shares.py), whatever one of its frames costs: the session that has had
least of the time does the next piece of work. A frame whose time has come competes with refinements and stills, which
have a smaller weight.
"""

from __future__ import annotations

from collections.abc import Iterable

from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.shares import Shares
from culet.engine.painting.still import StillQueue


def next_work(
    pictures: Iterable[LivePicture], stills: StillQueue, shares: Shares, now: float
) -> LivePicture | StillQueue | None:
    """What gets the next piece of the render thread's time; of equal claims the one that has waited longest."""
    waiting: list[tuple[float, float, LivePicture | StillQueue]] = [
        (shares.start(picture.next_account), picture.begun_at, picture)
        for picture in pictures
        if is_runnable(picture, now)
    ]
    if stills.next() is not None:
        waiting.append((shares.start(stills.account), stills.served_at, stills))
    return min(waiting, key=lambda claim: claim[:2], default=(0, 0, None))[2]


def is_runnable(picture: LivePicture, now: float) -> bool:
    """Whether there is work to do for a picture now."""
    if picture.work is not None:
        return picture.watched
    due_at = picture.due_at()
    return (due_at is not None and due_at <= now) or picture.wants_refinement()


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
