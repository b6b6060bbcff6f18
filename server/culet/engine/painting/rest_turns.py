"""Whose pictures at rest get better: as many at a time as fit into a bound of memory, by turns.

A picture at rest that is refined holds its sums and its light map, 48 MiB of a dozen stones between matte walls at
960x540. Of many sessions those would all be there at a time, though one render thread refines them one after the other.
So a picture that has no turn gives its memory back. What was seen of it stays. At its next turn it is begun anew,
and is seen again when it is better than before.

A turn is over when others wait and it has had its time of the render thread: 8 s, and each time twice as much as it
took before. So a picture that is begun anew has taken at most twice the time that it needed in the end, and one that
needs little waits for none that needs much.
"""

from __future__ import annotations

from collections.abc import Sequence

from culet.engine.painting.frame_work import WorkKind
from culet.engine.painting.live_picture import LivePicture
from culet.rendering.emitters.light_map import map_bytes
from culet.rendering.emitters.sources import mapped_surfaces

BOUND = 2**26
"""Bytes of pictures that are refined by turns; one is, however large it is."""
PIXEL_BYTES = 48
"""Of a picture at rest: two runs of its samples, and those that are shown until there are as many others."""
SETTLING_SECONDS = 1.0
"""s of work on a picture that is drawn in full, for which others wait that have come to rest, too."""


def resting_bytes(picture: LivePicture) -> int:
    """That a picture at rest of that size takes, or somewhat less."""
    width, height = picture.size
    return PIXEL_BYTES * width * height + map_bytes(mapped_surfaces(picture.session.shown.stage))


def take_turns(pictures: Sequence[LivePicture], now: float) -> None:
    """See to it that those have turns whose turn it is, and that others at rest hold no memory."""
    waiting = []
    for picture in pictures:
        turn = picture.turn
        if not picture.could_be_refined:
            turn.leave()
        elif not turn.has:
            turn.since = now if turn.since is None else turn.since
            waiting.append(picture)
    having = [picture for picture in pictures if picture.turn.has]
    for picture in having if waiting else []:
        if picture.turn.is_over(now) and picture.making is None:
            picture.turn.end(now)
    having = [picture for picture in having if picture.turn.has]
    held = sum(map(resting_bytes, having))
    for picture in sorted(waiting, key=lambda each: each.turn.claim(now)):
        held += resting_bytes(picture)
        if held > BOUND and having:
            break
        having.append(picture)
        picture.turn.begin(now)
    for picture in pictures:
        if picture.could_be_refined and not picture.turn.has:
            picture.put_down()


def waits_to_settle(picture: LivePicture, pictures: Sequence[LivePicture]) -> bool:
    """Whether a picture that has come to rest is not to be drawn in full yet: others are, whose memory is to be given
    back first. None is waited for that takes long."""
    if picture.work is not None or not picture.settled:
        return False
    others = [
        each for each in pictures
        if each.work is not None and each.work.kind is WorkKind.FULL and each.work.spent < SETTLING_SECONDS
    ]  # fmt: skip
    return bool(others) and sum(map(resting_bytes, [picture, *others])) > BOUND
