"""How many pictures each client waits for: stills, and turntables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from culet.errors import BusyError
from culet.gateway.limits.holdings import Holdings


class StillPlaces:
    """So many for each client; a place is given back when its picture is there, or its client gone."""

    def __init__(self, limit: int, what: str = "pictures", most: int | None = None) -> None:
        """`limit` for each client, `most` for all together, of `what`."""
        self._limit = limit
        self._what = what
        self._most = most
        self._taken = Holdings()

    def __len__(self) -> int:
        return self._taken.total

    @contextmanager
    def place(self, client: str) -> Iterator[None]:
        """Hold a place, or BusyError."""
        if self._taken.of(client) >= self._limit:
            raise BusyError(f"{client} waits for {self._limit} {self._what} already, which is the limit for one client")
        if self._most is not None and len(self) >= self._most:
            raise BusyError(f"as many {self._what} are being made as there may be at once; try again later")
        with self._taken.held(client):
            yield
