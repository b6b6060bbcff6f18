"""What was found lately of things that do not change, told apart by what they are and not by what they hold: to compare
a scene's lamps takes longer than to find out about them."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

KEPT = 8
"""Findings of a function: frames of so many sessions may take turns."""


def remembered(function: Callable[P, T]) -> Callable[P, T]:
    """The function, which is asked again only for what it was not asked lately. Its arguments must be immutable, and
    are kept alive; what it answers must not be changed. From any thread."""
    latest: list[tuple[tuple[object, ...], T]] = []

    @wraps(function)
    def found(*things: P.args, **named: P.kwargs) -> T:
        if named:
            raise TypeError(f"{function.__name__}: expected arguments by place, got {sorted(named)} by name")
        for known, answer in latest:
            if len(known) == len(things) and all(one is other for one, other in zip(known, things, strict=True)):
                return answer
        answer = function(*things, **named)
        latest[:] = [(things, answer), *latest[: KEPT - 1]]  # one assignment: who reads meanwhile sees either
        return answer

    return found
