"""Threads in which shapes are made, of each client in one at a time.

A shape may take seconds, as of a stone whose angles are changed with its meets kept, and a scene has up to 64 of them.
In the loop's own threads, in which motions wait for their steps too, a few such scenes would hold up every session.
Between two shapes, and after the last, what nobody waits for any more is given up.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import threading
from collections import Counter, deque
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractAsyncContextManager
from dataclasses import replace
from time import monotonic, thread_time
from typing import TypeVar

from culet.client_turns import ClientTurns
from culet.errors import BusyError, InputError
from culet.stage import Library

T = TypeVar("T")
Work = Callable[[Library], T]
"""Makes shapes by what scenes name, and what they are made for."""

THREADS = 64
"""Clients whose turns may go on at once, a shape of each after one of another's."""
SHAPES_AT_ONCE = 2
"""Shapes are made in Python, of which one thread goes on at a time: each more that computes keeps the engine's loop and
its renderer waiting longer. With one, a shape that takes seconds would hold up all others."""
MOST_WAITING = 320
"""Pieces of work of one client: a gateway lets 8 events of each of its 32 sessions be under way, and some stills."""
CHANGE_SECONDS = 8.0
"""Of a processor, for the shapes of a session's scene. A gateway waits 10 s for a change."""
WAIT_SECONDS = 9.0
"""After which a change is refused that waits for others of its client, or whose next shape still is to be made: before
a gateway would say that the engine does not answer."""


class _GivenUp(Exception):  # noqa: N818 - nothing went wrong
    """Nobody waits for it any more."""


class Patience:
    """How long a change may take that others of its client are before."""

    def __init__(self, seconds: float | None = None, *, clock: Callable[[], float] = monotonic) -> None:
        """So many seconds, WAIT_SECONDS if None."""
        self._seconds = WAIT_SECONDS if seconds is None else seconds
        self._clock = clock
        self._until = clock() + self._seconds

    def check(self) -> None:
        """BusyError if it is over. From any thread."""
        if self._clock() >= self._until:
            raise self._over()

    @contextlib.asynccontextmanager
    async def enter(self, waited: AbstractAsyncContextManager[T]) -> AsyncIterator[T]:
        """Within what has to be waited for; BusyError, if that takes too long."""
        async with contextlib.AsyncExitStack() as stack:
            try:
                async with asyncio.timeout(None if math.isinf(self._until) else self._until - self._clock()):
                    entered = await stack.enter_async_context(waited)
            except TimeoutError:
                raise self._over() from None
            yield entered

    def _over(self) -> BusyError:
        return BusyError(
            f"this was not done within {self._seconds:g} s, beside what else of yours is being done; try again later: "
            "shapes that were made are kept for a while"
        )


class Places:
    """So many threads at a time go on, in the order in which they came."""

    def __init__(self, free: int) -> None:
        self._free = free
        self._guard = threading.Lock()
        self.waiting: deque[threading.Lock] = deque()
        """Of each thread that waits, held until it may go on."""

    def take(self) -> None:
        """Wait for a place."""
        with self._guard:
            if self._free:
                self._free -= 1
                return
            mine = threading.Lock()
            mine.acquire()
            self.waiting.append(mine)
        mine.acquire()

    def give(self) -> None:
        """To the thread that has waited longest."""
        with self._guard:
            if self.waiting:
                self.waiting.popleft().release()
            else:
                self._free += 1


class Turn:
    """One of a client's, in which shapes may be made."""

    def __init__(
        self, threads: ThreadPoolExecutor, places: Places, library: Library, timer: Callable[[], float]
    ) -> None:
        self._threads = threads
        self._places = places
        self._library = library
        self._timer = timer

    async def make(
        self, work: Work[T], *, most_seconds: float = math.inf, check: Callable[[], object] = lambda: None
    ) -> T:
        """What the work gives. Before and after each shape it is checked, which may raise; InputError, if the shapes
        until then took more than so many seconds of a processor. Cancelled, it ends with the shape that is being made,
        and is waited for until then: nothing is changed by it after whoever holds a lock for it has let that go."""
        given_up = threading.Event()
        begun, looks = 0.0, 0

        def around_shape() -> None:
            nonlocal looks
            looks += 1
            if looks % 2 == 0:  # a shape was made: others make one of theirs
                self._places.give()
                self._places.take()
            if given_up.is_set():
                raise _GivenUp
            check()
            if (spent := self._timer() - begun) > most_seconds:
                raise InputError(
                    f"stones: expected shapes that take {most_seconds:g} s of a processor at most; those of the first "
                    f"{looks // 2} took {spent:.1f} s: change fewer stones at a time, or try again, since these are "
                    "kept for a while", "stones",
                )  # fmt: skip

        def run() -> T:
            nonlocal begun
            self._places.take()
            try:
                if given_up.is_set():  # while it waited for a place
                    raise _GivenUp
                begun = self._timer()
                return work(replace(self._library, around_shape=around_shape))
            finally:
                self._places.give()

        making = self._threads.submit(run)

        def give_up() -> None:
            given_up.set()
            making.cancel()

        return await to_its_end(asyncio.wrap_future(making), give_up)


class ShapesNeededError(Exception):
    """It cannot be done without a shape that has to be made."""


def without_shapes(library: Library) -> Library:
    """The same library for work that makes no shape: where it would, it raises ShapesNeededError."""

    def refuse() -> None:
        raise ShapesNeededError

    return replace(library, around_shape=refuse)


class Staging:
    """The turns of each client, in the order that they were asked for, and threads for them."""

    def __init__(self, library: Library, *, timer: Callable[[], float] = thread_time) -> None:
        """`timer` says how many seconds of a processor the thread that asks has taken."""
        self._library = library
        self._timer = timer
        self._threads = ThreadPoolExecutor(THREADS, "staging")
        self._turns = ClientTurns()
        self.places = Places(SHAPES_AT_ONCE)
        """For making a shape, of the threads."""
        self._waiting: Counter[str] = Counter()
        """Of each client, what has its turn or waits for one."""

    @contextlib.asynccontextmanager
    async def turn(self, client: str | None) -> AsyncIterator[Turn]:
        """Wait for the client's turn, and hold it; BusyError if too much waits for that."""
        name = client or ""
        if self._waiting[name] >= MOST_WAITING:
            raise BusyError(f"{self._waiting[name]} changes and pictures of yours wait already; try again later")
        self._waiting[name] += 1
        try:
            async with self._turns.turn(name):
                yield Turn(self._threads, self.places, self._library, self._timer)
        finally:
            self._waiting[name] -= 1
            if not self._waiting[name]:
                del self._waiting[name]

    async def make(self, client: str | None, work: Work[T]) -> T:
        """What the work gives, in the client's turn, however long it takes."""
        async with self.turn(client) as turn:
            return await turn.make(work)


async def to_its_end(working: asyncio.Future[T], give_up: Callable[[], object] = lambda: None) -> T:
    """The result of work in another thread, which is waited for even where nobody waits for this any more."""
    try:
        await asyncio.wait([working])  # which is not cancelled with this
    except asyncio.CancelledError:
        give_up()
        while not working.done():
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.wait([working])
        if not working.cancelled():
            working.exception()  # which is nobody's any more
        raise
    return working.result()
