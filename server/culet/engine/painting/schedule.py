"""What the one render thread does next: pure choices from what is due.

Every session has its share of the thread's time (shares.py), whatever one of its frames costs: the session that has had
least of the time does the next piece of work. A frame whose time has come competes with refinements and stills, which
have a smaller weight.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from culet.engine.painting.live_picture import LivePicture
from culet.engine.painting.rest_turns import waits_to_settle
from culet.engine.painting.shares import Account, Shares
from culet.engine.painting.still import StillQueue
from culet.rendering.emitters.sources import mapped_surfaces

WITH_LIGHT = 2
"""Frames with a light map of their own that are under way at a time: while one throws its light the other is drawn."""
ALIKE = 2.0
"""Frames of which none takes more than so many times as long as the other wait for each other. Of those that take
longer there are two more at a time for each factor of that."""


def next_work(
    pictures: Iterable[LivePicture], stills: StillQueue, shares: Shares, now: float
) -> LivePicture | StillQueue | None:
    """What gets the next piece of the render thread's time; of equal claims the one that has waited longest."""
    pictures = list(pictures)
    with_light = [each for each in pictures if has_own_light(each)]
    runnable = [
        each for each in pictures
        if is_runnable(each, now) and not waits_for_light(each, with_light) and not waits_to_settle(each, pictures)
    ]  # fmt: skip
    waiting: list[tuple[float, float, LivePicture | StillQueue]] = [
        (shares.start(picture.next_account), picture.begun_at, picture) for picture in runnable
    ]
    if stills.next() is not None:
        waiting.append((shares.start(stills.account), stills.served_at, stills))
    chosen = min(waiting, key=lambda claim: claim[:2], default=(0, 0, None))[2]
    if isinstance(chosen, LivePicture) and may_begin_light(chosen):  # all that waited have paid alike
        beginners = (each for each in runnable if may_begin_light(each) and is_alike(each, chosen))
        return min(beginners, key=lambda each: each.begun_at)
    return chosen


def is_runnable(picture: LivePicture, now: float) -> bool:
    """Whether there is work to do for a picture now."""
    if picture.work is not None:
        return picture.watched
    due_at = picture.due_at()
    return (due_at is not None and due_at <= now) or picture.wants_refinement()


def seconds_of_frame(picture: LivePicture) -> float:
    """s of work that a moving frame of it takes: as those lately did, or longer if the one under way has taken more."""
    lately = picture.quality.planned_seconds
    return lately if picture.work is None else max(lately, picture.work.spent)


def has_own_light(picture: LivePicture) -> bool:
    """Whether a frame is under way that has a light map of its own."""
    return picture.work is not None and picture.work.has_own_light


def may_begin_light(picture: LivePicture) -> bool:
    """Whether the next work is to begin a frame that may have a light map of its own."""
    begins = picture.work is None and picture.next_account is picture.frames
    return begins and bool(mapped_surfaces(picture.session.shown.stage))


def is_alike(picture: LivePicture, other: LivePicture) -> bool:
    """Whether both may begin frames with a light map, or have them under way, that take about as long."""
    if not all(has_own_light(each) or may_begin_light(each) for each in (picture, other)):
        return False
    less, more = sorted((picture, other), key=seconds_of_frame)
    first = all(each.quality.planned_seconds == 0 for each in (picture, other))  # of which nobody knows
    return first or seconds_of_frame(more) <= ALIKE * seconds_of_frame(less)


def waits_for_light(picture: LivePicture, with_light: Sequence[LivePicture]) -> bool:
    """Whether a frame is not to be begun before one of those is done that are under way and have a light map of their
    own."""
    if len(with_light) < WITH_LIGHT or not may_begin_light(picture):
        return False
    return sum(is_alike(each, picture) for each in with_light) >= WITH_LIGHT


def payers(picture: LivePicture, pictures: Iterable[LivePicture], now: float) -> list[tuple[Account, float]]:
    """Who pays for the next piece of a picture's work, and which part: those that wait for it, too, so that they have
    their share of the time, as all others have."""
    pictures = list(pictures)
    with_light = [each for each in pictures if has_own_light(each)]
    waiting = [
        each.frames
        for each in pictures
        if has_own_light(picture)
        and is_runnable(each, now)
        and waits_for_light(each, with_light)
        and is_alike(each, picture)
    ]
    parts = WITH_LIGHT + len(waiting) if waiting else 1
    own = WITH_LIGHT if waiting else 1
    return [(picture.next_account, own / parts), *((account, 1 / parts) for account in waiting)]


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
