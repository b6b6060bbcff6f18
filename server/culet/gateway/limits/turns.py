"""Turns of what HTTP brings: so many events of all connections together between two looks at everything else.

A body in chunks of one byte each (RFC 9112, 7.1) is an event for every six bytes: one read of 256 KiB would hold the
loop for half a second, and one from every connection for minutes.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import Protocol

import h11

EVENTS_IN_A_TURN = 256
"""Of all connections; each takes h11 some 15 us."""
EVENTS_AT_ONCE = 64
"""Of one connection, so that several get on in a turn."""
EVENTS_PER_SECOND = 10_000.0
"""Of one connection: a sixth of a processor. Chunks of 16 KiB, as programs send them, come at up to 160 MB/s so."""


class WaitingConnection(Protocol):
    """A connection that has more events than it was let have."""

    def go_on(self) -> None:
        """With the next ones."""


class Turns:
    """What is left of the loop's turn, and who waits for the next one."""

    def __init__(self) -> None:
        self.left = EVENTS_IN_A_TURN
        self._waiting: deque[WaitingConnection] = deque()
        self._next: asyncio.Handle | None = None

    def spend(self) -> None:
        """One event."""
        self.left -= 1
        self._call_soon()

    def wait(self, connection: WaitingConnection) -> None:
        """Have a connection go on in a later turn, after those that wait already."""
        self._waiting.append(connection)
        self._call_soon()

    def forget(self, connection: WaitingConnection) -> None:
        """A connection is gone."""
        if connection in self._waiting:
            self._waiting.remove(connection)

    def _call_soon(self) -> None:
        if self._next is None:
            self._next = asyncio.get_running_loop().call_soon(self._begin)

    def _begin(self) -> None:
        """Another turn: those that wait first, each once."""
        self._next, self.left = None, EVENTS_IN_A_TURN
        for _ in range(len(self._waiting)):
            if self.left <= 0:
                break
            self._waiting.popleft().go_on()
        if self._waiting:
            self._call_soon()


class TurnedConnection(h11.Connection):
    """h11's, which says that it needs more data once it has had its events of this turn."""

    def __init__(self, turns: Turns) -> None:
        super().__init__(h11.SERVER)
        self._turns = turns
        self.given = 0
        """Events since `begin`."""
        self.has_more = False
        """Whether there may be some that it did not give."""

    def begin(self) -> None:
        """It may give some again."""
        self.given, self.has_more = 0, False

    def next_event(self) -> h11.Event | type[h11.NEED_DATA] | type[h11.PAUSED]:
        """The next event, if it is its turn."""
        if self.given >= EVENTS_AT_ONCE or self._turns.left <= 0:
            self.has_more = True
            return h11.NEED_DATA
        event = super().next_event()
        if event is not h11.NEED_DATA and event is not h11.PAUSED:
            self.given += 1
            self._turns.spend()
        return event
