"""What was found lately is not looked for again."""

from __future__ import annotations

import pytest

from culet.remembered import KEPT, remembered


class Searching:
    """Counts how often it is asked."""

    def __init__(self) -> None:
        self.asked: list[tuple[int, ...]] = []

    def __call__(self, numbers: tuple[int, ...]) -> int:
        self.asked.append(numbers)
        return sum(numbers)


def test_the_same_thing_is_looked_for_once() -> None:
    searching = Searching()

    @remembered
    def find(numbers: tuple[int, ...]) -> int:
        return searching(numbers)

    things = [tuple(range(first, first + 3)) for first in range(KEPT)]
    for _ in range(3):
        assert [find(thing) for thing in things] == [sum(thing) for thing in things]
    assert searching.asked == things


def test_an_equal_thing_is_another_one() -> None:
    searching = Searching()

    @remembered
    def find(numbers: tuple[int, ...]) -> int:
        return searching(numbers)

    one, other = tuple(range(1, 3)), tuple(range(1, 3))
    assert one is not other
    assert find(one) == find(other) == 3
    assert len(searching.asked) == 2


def test_what_was_asked_longest_ago_is_forgotten() -> None:
    searching = Searching()

    @remembered
    def find(numbers: tuple[int, ...]) -> int:
        return searching(numbers)

    things = [(number, number) for number in range(KEPT + 1)]
    for thing in things:
        find(thing)
    find(things[-1])
    assert len(searching.asked) == KEPT + 1
    find(things[0])
    assert len(searching.asked) == KEPT + 2


def test_an_argument_by_name_is_refused() -> None:
    @remembered
    def find(numbers: tuple[int, ...]) -> int:
        return sum(numbers)

    with pytest.raises(TypeError, match="numbers"):
        find(numbers=(1, 2))
