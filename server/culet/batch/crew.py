"""Who does the pieces of long work: this process, one after the other, or workers (`culet.batch.cluster`)."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from itertools import islice
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
More = Callable[[int], Sequence[Item]]
"""Asked for so many items gives as many, or fewer if there are no more before another result is there. Work of which
none is being done, and of which there is no more, is done."""
Task = Callable[[Item], Result]
"""What is done with each item. It and its items are values that can be pickled, and it gives the same wherever it is
done."""
Done = Generator[tuple[Item, Result], None, None]
"""Items with their results, as these come."""


class Crew(Protocol):
    """Does work."""

    def results(self, task: Task[Item, Result], more: More[Item]) -> Done[Item, Result]:
        """Every item once, in any order; whoever stops listening ends the work. What the task raises is raised."""

    @property
    def alone(self) -> bool:
        """Whether this process does all, one item after the other; the same as long as there is the crew."""


class InProcess:
    """Does one item after the other, here."""

    def results(self, task: Task[Item, Result], more: More[Item]) -> Done[Item, Result]:
        """In the order of the items."""
        while items := more(1):
            for item in items:
                yield item, task(item)

    @property
    def alone(self) -> bool:
        """On all processors."""
        return True


IN_PROCESS = InProcess()


def in_turn(items: Iterable[Item]) -> More[Item]:
    """Items that are all known before."""
    left = iter(items)
    return lambda room: list(islice(left, room))
