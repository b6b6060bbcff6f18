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
"""A picture whose camera or scene changes again so soon after it was drawn, however long that took, is being moved: it
is governed as a falling one is, and drawn in full once this time has passed without a change. One that takes longer
than this in full is governed at its first change too, or nothing would be seen of the change meanwhile."""

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
    """s, steady clock: when something new had last been drawn, or been given up for something newer."""
    full_seconds: float = 0.0
    """Of rendering the first sample of the picture that was last drawn in full."""
    refinement: Iterator[Any] | None = None
    """More samples on their way, a band at a time."""
    refused: Shown | None = None
    """What could not be rendered; not tried again until something else is to be shown."""
    message: bytes | None = None
    """The frame sent last."""
    told_asleep: bool = False
    """The gateway was told unasked that the stone sleeps."""
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

    @property
    def governed(self) -> bool:
        """Whether the governor is to choose how the frame just begun is drawn."""
        shown = self.session.shown
        if shown.moving or shown is self.painted:  # in the latter case only the size changed, or it is drawn in full
            return shown.moving
        again = self.begun_at - self.changed_at < max(SETTLE_SECONDS, 2 / self.frames_per_second)
        return again or self.full_seconds > SETTLE_SECONDS

    def drew(self, picture: Picture | None, shown: Shown, size: tuple[int, int], now: float, *, reduced: bool) -> None:
        """The first sample of a picture is there; None if it was given up for something newer."""
        if picture is None or shown is not self.painted:
            self.changed_at = now
        if picture is None:
            return
        self.picture, self.painted, self.painted_size, self.final = picture, shown, size, REST_SAMPLES <= 1
        self.render_seconds = picture.seconds
        self.reduced_until = now + SETTLE_SECONDS if reduced else None
        if not reduced:
            self.full_seconds = picture.seconds

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
        """Nobody watches: free the picture's memory, keep the message, and what it shows if that is still shown."""
        self.picture = None
        self.refinement = None
        if self.painted is not self.session.shown:
            self.painted = None

    def repeat_at(self) -> float | None:
        """When the frame sent last is to be sent again."""
        return self.sent_at + REPEAT_SECONDS if self.watched and self.current and self.message else None
