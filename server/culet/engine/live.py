"""The live picture of one session: who wants it, how good it is, and when its next frame is due."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from culet.engine.drawing import Picture
from culet.engine.governor import Governor, asked_rate, read_ladder
from culet.engine.session import Session, Shown

NATIVE_RATE = 30.0
"""Frames per second for viewers that only subscribe, and cannot say what they take."""
NATIVE_SIZE = (960, 540)
"""Pixels, likewise."""

REST_SAMPLES = 16
"""Samples per pixel of a picture at rest, reached by doubling. More is what stills are for."""

SETTLE_SECONDS = 0.2
"""A picture whose camera or scene has changed twice within this time is being moved: it is governed as a falling one
is, and drawn in full once this time has passed without a change."""

REPEAT_SECONDS = 1.0
"""A picture at rest is sent again this often: a high-water mark drops the newest message, maybe the last one."""

LADDER = read_ladder()


@dataclass(eq=False)
class LivePicture:
    """Mutable; belongs to the painter."""

    session: Session
    watched: bool = False
    """Somebody subscribes to the session's frames. That, and not what a gateway demanded, is why frames are made: a
    subscription ends with its subscriber, however that ends."""
    rate: float = 0.0
    """Frames per second that the gateway's viewers can take; 0 if it has none."""
    size: tuple[int, int] = NATIVE_SIZE
    picture: Picture | None = None
    painted: Shown | None = None
    """What the picture shows."""
    painted_size: tuple[int, int] = (0, 0)
    governor: Governor = field(default_factory=lambda: Governor(LADDER))
    reduced_until: float | None = None
    """s, steady clock: from when on a picture that the governor has reduced is to be drawn in full, if nothing moves.
    None if it is in full."""
    changed_at: float = -1e9
    """s, steady clock: when something new was last drawn."""
    refinement: Iterator[Any] | None = None
    """More samples on their way, a band at a time."""
    refused: Shown | None = None
    """What could not be rendered; not tried again until something else is to be shown."""
    message: bytes | None = None
    """The frame sent last."""
    final: bool = False
    """The picture has all its samples."""
    sent_at: float = 0.0
    """s, steady clock."""
    begun_at: float = -1e9
    """s, steady clock: when the last frame was begun, or should have been if it was a little late."""
    served_at: float = -1e9
    """s, steady clock: when a refinement last got its turn."""
    publishing: asyncio.Task[None] | None = None
    simulate_seconds: float = 0.0
    render_seconds: float = 0.0
    """Of all samples of the picture."""

    @property
    def frames_per_second(self) -> float:
        """The rate to keep to; a native viewer takes what the gateway's viewers take, if there are any."""
        return asked_rate(self.session.balance, self.rate or NATIVE_RATE)

    @property
    def current(self) -> bool:
        """Whether the picture, and the frame made of it, still are what is shown."""
        return self.painted is self.session.shown and self.painted_size == self.size

    @property
    def at_rest(self) -> bool:
        """Whether the picture is right until somebody changes something."""
        return self.current and not self.session.moving

    def due_at(self) -> float | None:
        """When the next first-sample frame is to be begun (steady clock), or None if nothing calls for one."""
        if not self.watched or self.refused is self.session.shown:
            return None
        if self.session.lock.locked():  # a stone is being made, which may take seconds: others need not wait for it
            return None
        if self.at_rest:
            if self.reduced_until is not None:
                return max(self.reduced_until, self.begun_at + 1 / self.frames_per_second)
            if self.final or self.picture is not None:
                return None
        return self.begun_at + 1 / self.frames_per_second

    def begin(self, now: float) -> None:
        """A frame is begun. One that is late by less than a frame does not make those after it late."""
        due = self.due_at()
        little = due is not None and 0 <= now - due < 1 / self.frames_per_second
        self.begun_at = due if due is not None and little else now

    def wants_refinement(self) -> bool:
        """Whether more samples would improve what is seen."""
        in_full = self.reduced_until is None and self.picture is not None
        return self.watched and self.at_rest and not self.final and in_full

    def abandon(self) -> None:
        """Nobody watches: free the picture's memory, keep the message."""
        self.picture = None
        self.refinement = None

    def repeat_at(self) -> float | None:
        """When the frame sent last is to be sent again."""
        return self.sent_at + REPEAT_SECONDS if self.watched and self.current and self.message else None
