"""One viewer of a session: what it wants, what it was sent, what it is to be told. No sockets here: see `stream`."""

from __future__ import annotations

import asyncio
from collections import deque

from culet.gateway.credit import Credit
from culet_protocol.frame import Frame
from culet_protocol.messages import Message, State

NOTICES_WAITING = 256
"""A viewer that has so many unread ones does not read at all."""
SETTLING_SECONDS = 0.25
"""A new viewer has so long to say its size before frames are rendered for the default one."""
DEFAULT_SIZE = (960, 540)
"""Pixels, for viewers that never say."""


class Viewer:
    """The credit rule: wait for credit, then take the latest frame, then send. Nothing taken is ever dropped."""

    def __init__(self, number: int, now: float) -> None:
        self.number = number
        self.visible = True
        self.size: tuple[int, int] | None = None
        self.watching_since = now
        """When it came, or was last seen again after it was hidden."""
        self.credit = Credit()
        self.wake = asyncio.Event()
        """Set when there may be something to send."""
        self.overrun = False
        """More notices are waiting than a reading viewer would leave."""
        self.dismissed = False
        """The session is gone: the stream ends once the notices are out."""
        self._joined_at = now
        self._latest: tuple[int, bytes] | None = None
        self._sent: int | None = None
        self._notices: deque[Message] = deque()

    def watches(self, now: float) -> bool:
        """Whether frames are wanted: it can be seen, and it said its size or had the time to."""
        return self.visible and (self.size is not None or now - self._joined_at >= SETTLING_SECONDS)

    def resize(self, width: int, height: int) -> None:
        """The size it would like, in pixels."""
        self.size = (width, height)

    def show(self, visible: bool, now: float) -> None:
        """It can, or cannot, be seen."""
        if visible and not self.visible:
            self.watching_since = now
        self.visible = visible
        self.wake.set()

    def dismiss(self) -> None:
        """End the stream."""
        self.dismissed = True
        self.wake.set()

    def acknowledge(self, sequence: int, now: float) -> None:
        """It showed the frame of that number."""
        self.credit.acknowledge(sequence, now)
        self.wake.set()

    def offer(self, frame: Frame, message: bytes) -> None:
        """The session's latest frame; one that it was offered before and has not taken is forgotten."""
        self._latest = (frame.sequence, message)
        self.wake.set()

    def restart(self) -> None:
        """Another engine counts its frames from 1 again."""
        self._latest = self._sent = None
        self.credit.clear()

    def tell(self, notice: Message) -> None:
        """Queue a notice; of states only the latest matters."""
        if isinstance(notice, State):
            self._notices = deque(waiting for waiting in self._notices if not isinstance(waiting, State))
        self._notices.append(notice)
        self.overrun = len(self._notices) > NOTICES_WAITING
        self.wake.set()

    def next_notice(self) -> Message | None:
        """The oldest notice, taken from the queue."""
        return self._notices.popleft() if self._notices else None

    def next_frame(self, now: float) -> bytes | None:
        """The latest frame if it is new to the viewer and there is credit for it; that is then used."""
        if self._latest is None or not self.visible or self._latest[0] == self._sent:
            return None
        sequence, message = self._latest
        if not self.credit.available(now):
            return None
        self._sent = sequence
        self.credit.take(sequence, now)
        return message

    def rate(self, now: float) -> float:
        """Frames per second that it can take now."""
        return self.credit.rate(now) if self.watches(now) else 0.0

    def sleep_until(self) -> float | None:
        """When a credit returns by itself, if a frame waits for one."""
        waiting = self._latest is not None and self.visible and self._latest[0] != self._sent
        return self.credit.returns_at() if waiting else None
