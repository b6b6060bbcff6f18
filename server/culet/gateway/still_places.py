"""How many stills each client waits for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from culet.errors import BusyError


class StillPlaces:
    """So many for each client; a place is given back when its still is there, or its client gone."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._taken: Counter[str] = Counter()

    def __len__(self) -> int:
        return self._taken.total()

    @contextmanager
    def place(self, client: str) -> Iterator[None]:
        """Hold a place, or BusyError."""
        if self._taken[client] >= self._limit:
            raise BusyError(f"{client} waits for {self._limit} pictures already, which is the limit for one client")
        self._taken[client] += 1
        try:
            yield
        finally:
            self._taken[client] -= 1
            if not self._taken[client]:
                del self._taken[client]
