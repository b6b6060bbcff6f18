"""How much of something each client holds at the moment, for the limits of what one client may hold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager


class Holdings:
    """Amounts by client. A client that holds nothing is forgotten, so this never grows with those who came and went."""

    def __init__(self) -> None:
        """Nobody holds anything."""
        self._amounts: Counter[str | None] = Counter()

    def __len__(self) -> int:
        """Clients that hold something."""
        return len(self._amounts)

    def of(self, client: str | None) -> int:
        """What the client holds; None stands for all whose client is not known."""
        return self._amounts[client]

    @property
    def total(self) -> int:
        """What all clients hold together."""
        return self._amounts.total()

    def take(self, client: str | None, amount: int = 1) -> None:
        """The client holds so much more."""
        self._amounts[client] += amount

    def give_back(self, client: str | None, amount: int = 1) -> None:
        """The client holds so much less."""
        self._amounts[client] -= amount
        if not self._amounts[client]:
            del self._amounts[client]

    @contextmanager
    def held(self, client: str | None, amount: int = 1) -> Iterator[None]:
        """The client holds so much more for a while."""
        self.take(client, amount)
        try:
            yield
        finally:
            self.give_back(client, amount)
