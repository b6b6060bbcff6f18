"""How many stills each client waits for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from culet.errors import BusyError
from culet.gateway.holdings import Holdings


class StillPlaces:
    """So many for each client; a place is given back when its still is there, or its client gone."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._taken = Holdings()

    def __len__(self) -> int:
        return self._taken.total

    @contextmanager
    def place(self, client: str) -> Iterator[None]:
        """Hold a place, or BusyError."""
        if self._taken.of(client) >= self._limit:
            raise BusyError(f"{client} waits for {self._limit} pictures already, which is the limit for one client")
        with self._taken.held(client):
            yield
