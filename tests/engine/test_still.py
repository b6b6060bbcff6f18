import pytest

from culet.engine.still import Still, StillQueue
from culet.errors import BusyError
from culet.scene import Scene


def still() -> Still:
    return Still(Scene(stones=()), None, 16, 16, 1, "tga")


async def test_stills_come_out_in_the_order_they_went_in() -> None:
    queue, stills = StillQueue(3), [still() for _ in range(3)]
    for one in stills:
        queue.put(one)
    for one in stills:
        assert queue.first() is one
        queue.remove(one)
    assert queue.first() is None


async def test_a_full_queue_says_so_and_has_room_again_later() -> None:
    queue, first = StillQueue(1), still()
    queue.put(first)
    with pytest.raises(BusyError, match="1 stills are waiting"):
        queue.put(still())
    queue.remove(first)
    queue.put(still())


async def test_a_still_that_nobody_waits_for_any_more_takes_no_place() -> None:
    queue, abandoned, other = StillQueue(1), still(), still()
    queue.put(abandoned)
    abandoned.done.cancel()
    queue.put(other)
    assert queue.first() is other
    queue.remove(abandoned)  # by the painter, which was at it
    assert len(queue) == 1
