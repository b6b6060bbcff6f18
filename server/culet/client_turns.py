"""Work of which each client has one piece at a time, so that many requests of one take no more than one of another."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from weakref import WeakValueDictionary


class ClientTurns:
    """The turns of each client, in the order that they were asked for."""

    def __init__(self) -> None:
        self._locks: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        """Of clients that have a turn or wait for one."""

    def __len__(self) -> int:
        return len(self._locks)

    @asynccontextmanager
    async def turn(self, client: str) -> AsyncIterator[None]:
        """Wait for the client's turn, and hold the turn."""
        lock = self._locks.setdefault(client, asyncio.Lock())
        async with lock:
            yield
