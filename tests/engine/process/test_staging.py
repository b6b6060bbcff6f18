"""Shapes that take long hold up their own client alone, and nobody once nobody waits for them."""

from __future__ import annotations

import asyncio
import gc
import threading
from functools import partial
from typing import Any

import pytest

from culet.engine.process.staging import (
    CHANGE_SECONDS,
    MOST_WAITING,
    SHAPES_AT_ONCE,
    Patience,
    ShapesNeededError,
    Staging,
    to_its_end,
    without_shapes,
)
from culet.errors import BusyError, InputError, NotFoundError
from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.scene import Scene
from culet.stage import Library, Stage
from shared.patience import PATIENCE

THREE = Scene.read({"stones": [{"cut": cut} for cut in ("single", "baguette", "rose")]})


class Held:
    """Work in a thread that goes on when it is let."""

    def __init__(self) -> None:
        self.begun, self.go_on, self.shapes = threading.Event(), threading.Event(), 0

    def __call__(self, library: Library) -> int:
        self.begun.set()
        assert self.go_on.wait(PATIENCE)
        for _ in range(3):
            library.around_shape()
            self.shapes += 1
        return self.shapes

    async def until_begun(self) -> None:
        assert await asyncio.to_thread(self.begun.wait, PATIENCE)


async def test_a_client_makes_shapes_one_after_the_other_while_another_makes_its_own() -> None:
    staging, first, second = Staging(Library()), Held(), Held()
    one, two = (asyncio.create_task(staging.make("a", held)) for held in (first, second))
    await first.until_begun()
    stage = await staging.make("b", lambda library: Stage.of(THREE, library))
    assert len(stage.shapes) == 3
    assert not second.begun.is_set()
    first.go_on.set()
    second.go_on.set()
    assert (await one, await two) == (3, 3)


async def test_what_nobody_waits_for_ends_before_its_next_shape_and_its_turn_with_it() -> None:
    staging, given_up, other = Staging(Library()), Held(), Held()
    first = asyncio.create_task(staging.make("a", given_up))
    await given_up.until_begun()
    waiting = asyncio.create_task(staging.make("a", other))
    first.cancel()
    await asyncio.sleep(0)
    first.cancel()  # as a client that leaves while the engine stops
    await asyncio.sleep(0)
    assert not first.done(), "what it may change is locked until it has ended"
    given_up.go_on.set()
    with pytest.raises(asyncio.CancelledError):
        await first
    assert given_up.shapes == 0
    other.go_on.set()
    assert await waiting == 3


async def test_what_was_not_begun_is_never_begun() -> None:
    staging, first, never = Staging(Library()), Held(), Held()
    one, two = (asyncio.create_task(staging.make("a", held)) for held in (first, never))
    await first.until_begun()
    two.cancel()
    with pytest.raises(asyncio.CancelledError):
        await two
    first.go_on.set()
    assert await one == 3
    assert not never.begun.is_set()


async def test_what_waits_for_a_place_when_it_is_given_up_is_never_begun() -> None:
    staging, never = Staging(Library()), Held()
    others = [Held() for _ in range(SHAPES_AT_ONCE)]
    tasks = [asyncio.create_task(staging.make(str(number), held)) for number, held in enumerate(others)]
    for held in others:
        await held.until_begun()
    waiting = asyncio.create_task(staging.make("one more", never))
    await asyncio.sleep(0)
    waiting.cancel()
    await asyncio.sleep(0)
    for held in others:
        held.go_on.set()
    with pytest.raises(asyncio.CancelledError):
        await waiting
    assert await asyncio.gather(*tasks) == [3] * SHAPES_AT_ONCE
    assert not never.begun.is_set()
    assert not staging._waiting, "nothing is kept of clients that wait for nothing"


def test_a_library_is_looked_at_before_and_after_each_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    done = []

    def noted(*arguments: Any) -> Shape:  # noqa: ANN401
        done.append("shape")
        return shape_of(*arguments)

    monkeypatch.setattr("culet.stage.shape_of", noted)
    Stage.of(THREE, Library(around_shape=lambda: done.append("look")))
    assert done == ["look", "shape", "look"] * 3


async def test_a_change_is_refused_whose_shapes_take_too_long_and_a_smaller_one_is_not() -> None:
    seconds = iter(range(0, 100, 3))
    staging = Staging(Library(), timer=lambda: float(next(seconds)))
    async with staging.turn("a") as turn:
        with pytest.raises(InputError) as refused:
            await turn.make(lambda library: Stage.of(THREE, library), most_seconds=CHANGE_SECONDS)
    assert refused.value.field == "stones"
    assert str(refused.value) == (
        "stones: expected shapes that take 8 s of a processor at most; those of the first 1 took 9.0 s: change fewer "
        "stones at a time, or try again, since these are kept for a while"
    )
    one = THREE.model_copy(update={"stones": THREE.stones[:1]})
    async with staging.turn("a") as turn:
        stage = await turn.make(lambda library: Stage.of(one, library), most_seconds=CHANGE_SECONDS)
    assert len(stage.shapes) == 1


async def test_a_change_whose_time_is_over_ends_before_its_next_shape() -> None:
    now = iter((0.0, 1.0, 8.0, 9.0))  # when it came, and before and after shapes
    patience, looks = Patience(9.0, clock=lambda: next(now)), 0

    def work(library: Library) -> None:
        nonlocal looks
        for _ in range(4):
            library.around_shape()
            looks += 1

    async with Staging(Library()).turn("a") as turn:
        with pytest.raises(BusyError, match="not done within 9 s"):
            await turn.make(work, check=patience.check)
    assert looks == 2


async def test_nothing_is_made_for_a_session_that_is_gone() -> None:
    def gone() -> None:
        raise NotFoundError("no such session; it may have expired")

    async with Staging(Library()).turn("a") as turn:
        with pytest.raises(NotFoundError):
            await turn.make(lambda library: Stage.of(THREE, library), check=gone)


async def test_a_client_that_lets_more_wait_than_a_gateway_would_is_refused() -> None:
    staging, held = Staging(Library()), Held()
    tasks = [asyncio.create_task(staging.make("a", held)) for _ in range(MOST_WAITING)]
    await held.until_begun()
    with pytest.raises(BusyError, match=f"{MOST_WAITING} changes and pictures of yours wait already"):
        await staging.make("a", held)
    for task in tasks[1:]:
        task.cancel()
    await asyncio.gather(*tasks[1:], return_exceptions=True)
    held.go_on.set()
    assert await tasks[0] == 3
    assert await staging.make("a", held) == 6


async def test_an_error_of_what_nobody_waits_for_is_told_nobody() -> None:
    unseen: list[object] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: unseen.append(context))
    working: asyncio.Future[None] = asyncio.get_running_loop().create_future()
    waiting = asyncio.create_task(to_its_end(working, partial(working.set_exception, ValueError)))
    await asyncio.sleep(0)
    waiting.cancel()
    await asyncio.wait([waiting])
    assert waiting.cancelled()
    del working, waiting
    gc.collect()
    assert unseen == []


async def test_what_makes_no_shape_needs_no_turn_and_what_would_has_changed_nothing() -> None:
    library = Library()
    stage = Stage.of(THREE, library)
    moved = THREE.model_copy(update={"camera": THREE.camera.model_copy(update={"fov_degrees": 30.0})})
    assert Stage.of(moved, without_shapes(library), before=stage).shapes == stage.shapes
    with pytest.raises(ShapesNeededError):
        Stage.of(THREE, without_shapes(library))


async def test_a_shape_that_nobody_waits_for_when_it_is_made_changes_nothing() -> None:
    staging, making, go_on = Staging(Library()), threading.Event(), threading.Event()
    changed = []

    def change(library: Library) -> None:
        library.around_shape()
        making.set()
        assert go_on.wait(PATIENCE)  # the last shape
        library.around_shape()
        changed.append(True)

    changing = asyncio.create_task(staging.make("a", change))
    assert await asyncio.to_thread(making.wait, PATIENCE)
    changing.cancel()
    await asyncio.sleep(0)
    go_on.set()
    with pytest.raises(asyncio.CancelledError):
        await changing
    assert changed == []


async def test_shapes_of_one_client_are_made_between_those_of_others() -> None:
    staging, order, go_on = Staging(Library()), list[str](), threading.Event()

    def work(name: str, library: Library) -> None:
        assert go_on.wait(PATIENCE)
        for _ in range(4):
            library.around_shape()
            order.append(name)
            library.around_shape()

    clients = "abcdef"
    making = [asyncio.create_task(staging.make(name, partial(work, name))) for name in clients]
    async with asyncio.timeout(PATIENCE):
        while len(staging.places.waiting) < len(clients) - SHAPES_AT_ONCE:  # noqa: ASYNC110 - threads tell nobody
            await asyncio.sleep(0.001)
    go_on.set()
    await asyncio.gather(*making)
    assert sorted(order) == sorted(clients * 4)
    half = order[: len(order) // 2]
    assert all(half.count(name) < 4 for name in clients), f"nobody's are all made first: {order}"
