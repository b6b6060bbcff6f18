"""The one thread that renders, and whose time each piece of its work is."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from culet.engine.painting.counters import SharedCounters
from culet.engine.painting.shares import Account, Shares

T = TypeVar("T")


class RenderThread:
    """Runs one piece of work after the other."""

    def __init__(
        self, executor: ThreadPoolExecutor, shares: Shares, tally: SharedCounters, clock: Callable[[], float]
    ) -> None:
        """`executor` has one thread, `clock` is a steady one, in seconds."""
        self._executor = executor
        self._shares = shares
        self._tally = tally
        self._now = clock

    async def run(self, account: Account, call: Callable[..., T], *arguments: object) -> T:
        """The account pays for the time that this holds the thread."""
        held = 0.0

        def timed() -> T:
            nonlocal held
            started = self._now()
            try:
                return call(*arguments)
            finally:
                held = self._now() - started

        try:
            return await asyncio.get_running_loop().run_in_executor(self._executor, timed)
        finally:
            self._tally.counters.render_seconds += held
            self._tally.durations.render_hold.add(held)
            self._shares.charge(account, held, self._now())
