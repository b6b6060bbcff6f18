"""The engine's memory: what holds how much of it, and the one budget that all of it stays within.

A part that holds memory says how much (`count`). A part that can give memory back says so (`give_back`). A part that is
about to take more memory reserves it first: the reservation makes room or is refused. Nothing here allocates anything.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from culet.errors import BusyError

MEBIBYTE = 2**20


class Memory:
    """Bytes by kind, against a budget."""

    def __init__(self, budget: int) -> None:
        self.budget = budget
        """Bytes of all kinds together."""
        self._held: dict[str, Callable[[], int]] = {}
        self._givers: list[Callable[[int], object]] = []
        self._reserved: dict[str, int] = {}

    def count(self, kind: str, held: Callable[[], int]) -> None:
        """From now on ask for what is held of a kind."""
        self._held[kind] = held

    def give_back(self, giver: Callable[[int], object]) -> None:
        """What gives back up to so many bytes that nobody needs now, if it has them; the first named is asked first."""
        self._givers.append(giver)

    def held(self) -> dict[str, int]:
        """Bytes by kind, those reserved among them."""
        held = {kind: count() for kind, count in self._held.items()}
        for kind, size in self._reserved.items():
            held[kind] = held.get(kind, 0) + size
        return held

    @property
    def free(self) -> int:
        """Bytes that may still be taken; below 0 if more is held than may be."""
        return self.budget - sum(self.held().values())

    def make_room(self, size: int) -> int:
        """Have given back what nobody needs until so many bytes are free; how many are."""
        for give in self._givers:
            free = self.free
            if free >= size:
                break
            give(size - free)
        return self.free

    @contextlib.contextmanager
    def reserved(self, kind: str, size: int, what: str) -> Iterator[None]:
        """So many bytes are kept free for a while; BusyError, naming what they are for, if they cannot be."""
        free = self.make_room(size)
        if free < size:
            raise BusyError(
                f"{what} needs {_shown(size)} of memory, {_shown(max(0, free))} of the {_shown(self.budget)} that this "
                "server may take are free; try again later"
            )
        self._reserved[kind] = self._reserved.get(kind, 0) + size
        try:
            yield
        finally:
            self._reserved[kind] -= size


def _shown(size: int) -> str:
    return f"{size / MEBIBYTE:.0f} MiB"
