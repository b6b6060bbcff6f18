import pytest

from culet.engine.painting.still import Still, StillQueue
from culet.errors import BusyError
from culet.rendering.film.target import Target
from culet.scene import Scene
from culet.stage import Stage

LARGEST = 2**20


def still(client: str = "", pixels: int = 16) -> Still:
    return Still(Stage.of(Scene(stones=())), pixels, 1, Target(1), "tga", client=client)


def begun(queue: StillQueue) -> Still | None:
    """The next one, which is then under way."""
    chosen = queue.next()
    if chosen is not None:
        chosen.pieces = iter(())
    return chosen


async def test_stills_of_one_client_come_out_in_the_order_they_went_in() -> None:
    queue, stills = StillQueue(3, LARGEST), [still() for _ in range(3)]
    for one in stills:
        queue.put(one)
    for one in stills:
        assert begun(queue) is one
        queue.charge(one, 1.0, 0.0)
        assert queue.next() is one
        queue.remove(one)
    assert queue.next() is None


async def test_clients_take_turns_by_time() -> None:
    """One has queued four large stills, the other asks for a small one after each that it gets."""
    queue, seconds = StillQueue(8, LARGEST), {"many": 0.0, "one": 0.0}
    for _ in range(4):
        queue.put(still("many", 400_000))
    queue.put(still("one"))
    for _ in range(1000):
        chosen = begun(queue)
        assert chosen is not None
        cost = 0.02 if chosen.client == "many" else 0.005
        queue.charge(chosen, cost, 0.0)
        seconds[chosen.client] += cost
        if chosen.client == "one":
            queue.remove(chosen)
            queue.put(still("one"))
    assert seconds["one"] / seconds["many"] == pytest.approx(1, rel=0.05), "measured 0.999"


async def test_one_client_takes_no_more_than_half_of_the_places() -> None:
    queue = StillQueue(4, LARGEST)
    for _ in range(2):
        queue.put(still("many"))
    with pytest.raises(BusyError, match="2 stills of yours"):
        queue.put(still("many"))
    for _ in range(2):
        queue.put(still("other"))
    with pytest.raises(BusyError, match="4 stills are waiting"):
        queue.put(still("third"))


async def test_stills_under_way_have_together_not_much_more_pixels_than_the_largest() -> None:
    queue, large, second, small = StillQueue(8, LARGEST), still("a", LARGEST), still("b", LARGEST), still("c")
    for one in (large, second, small):
        queue.put(one)
    assert begun(queue) is large
    queue.charge(large, 1.0, 0.0)
    assert begun(queue) is small, "which needs not wait for the end of the large one"
    queue.charge(small, 2.0, 0.0)
    assert queue.next() is large
    queue.remove(large)
    assert begun(queue) is second


async def test_a_still_that_is_being_encoded_lets_the_next_one_go_on_and_keeps_its_place() -> None:
    queue, first, second = StillQueue(2, LARGEST), still(), still()
    queue.put(first)
    queue.put(second)
    assert begun(queue) is first
    first.rendered = True
    assert queue.next() is second
    with pytest.raises(BusyError):
        queue.put(still())


async def test_a_full_queue_says_so_and_has_room_again_later() -> None:
    queue, first = StillQueue(1, LARGEST), still()
    queue.put(first)
    with pytest.raises(BusyError, match="1 stills are waiting"):
        queue.put(still())
    queue.remove(first)
    queue.put(still())


async def test_a_still_that_nobody_waits_for_any_more_takes_no_place() -> None:
    queue, abandoned, other = StillQueue(1, LARGEST), still("gone"), still()
    queue.put(abandoned)
    abandoned.done.cancel()
    queue.put(other)
    assert queue.next() is other
    queue.remove(abandoned)  # by the painter, which was at it
    queue.charge(abandoned, 1.0, 0.0)
    assert len(queue) == 1
