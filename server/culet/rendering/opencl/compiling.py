"""Whether a compiler is at work in this process: who watches that it does not hang must have patience meanwhile."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

_lock = threading.Lock()
_under_way = 0
_listeners: list[Callable[[bool], None]] = []


def listen(listener: Callable[[bool], None]) -> None:
    """Be told, by whatever thread, when the first of some compilations begins (True), and when the last ends."""
    _listeners.append(listener)


@contextlib.contextmanager
def compiling() -> Iterator[None]:
    """A compilation, from its beginning to its end."""
    _count(1)
    try:
        yield
    finally:
        _count(-1)


def _count(change: int) -> None:
    global _under_way
    with _lock:
        before, _under_way = _under_way, _under_way + change
        changed = bool(before) != bool(_under_way)
        for listener in _listeners if changed else ():
            listener(bool(_under_way))
