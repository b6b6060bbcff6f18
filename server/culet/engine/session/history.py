"""What a session has shown lately, so that a frame can be rendered again in full quality."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

from culet.errors import NotFoundError
from culet.scene import Scene


@dataclass(frozen=True)
class Past:
    """What was shown, by the names of its mesh and sky: however long it is remembered, it keeps neither."""

    step: int
    scene: Scene
    """With the live camera and the stone's pose."""


class History:
    """The latest of what was shown, each by its step."""

    def __init__(self, length: int) -> None:
        """That remembers so many."""
        self._length = length
        self._pasts: OrderedDict[int, Past] = OrderedDict()

    def __len__(self) -> int:
        return len(self._pasts)

    def add(self, past: Past) -> None:
        """Remember it; the oldest is forgotten if there are too many."""
        self._pasts[past.step] = past
        while len(self._pasts) > self._length:
            self._pasts.popitem(last=False)

    def at(self, step: int, now: Past) -> Past:
        """What was shown at a step, which may be `now`; NotFoundError."""
        if step == now.step:
            return now
        try:
            return self._pasts[step]
        except KeyError:
            raise NotFoundError(
                f"step {step} was never shown or is forgotten; the session is at step {now.step} "
                f"and keeps the last {self._length} that it showed"
            ) from None
