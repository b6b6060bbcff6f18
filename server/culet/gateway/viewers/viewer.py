"""One viewer of a session: what it wants, what it was sent, what it is to be told. No sockets here: see `stream`."""

from __future__ import annotations

import asyncio
from enum import Enum, auto
from typing import Literal, assert_never

from culet.gateway.identity.client_address import UNKNOWN
from culet.gateway.viewers.credit import Credit
from culet.gateway.viewers.frame_feed import FrameFeed
from culet_protocol.frame import Codec, Frame
from culet_protocol.messages import (
    Change,
    Engine,
    Fall,
    Hello,
    Leaving,
    Message,
    Notice,
    Outlined,
    Picked,
    Pong,
    Problem,
    Reached,
    Snapshot,
    State,
    Viewers,
)
from culet_protocol.parts import changed_parts
from culet_protocol.watch import Stream

NOTICES_WAITING = 256
"""A viewer that has so many unread ones does not read at all."""
SETTLING_SECONDS = 0.25
"""A new viewer has so long to say its size before frames are rendered for the default one."""
STATE_SECONDS = 0.04
"""Between two states: a drag makes 60 or 120 a second, and sliders follow at 25."""


class Standing(Enum):
    """How a viewer's stream is. Of those that end it the first counts."""

    ATTENDING = auto()
    OVERRUN = auto()
    """More notices are waiting than a reading viewer would leave: the stream ends at once."""
    DISMISSED = auto()
    """The session is gone: the stream ends once the notices are out."""
    STOPPING = auto()
    """The server stops: the stream ends once the notices are out."""


class Viewer:
    """The credit rule: wait for credit, then take the latest frame, then send. Nothing taken is ever dropped."""

    def __init__(self, number: int, now: float, client: str = UNKNOWN, *, steers: bool = True) -> None:
        self.number = number
        self.client = client
        self.steers = steers
        """What it says may change the session; else it only watches."""
        self.visible = True
        self.size: tuple[int, int] | None = None
        self.watching_since = now
        """When it came, or was last seen again after it was hidden."""
        self.credit = Credit()
        self.wake = asyncio.Event()
        """Set when there may be something to send."""
        self.standing = Standing.ATTENDING
        self._joined_at = now
        self.feed = FrameFeed()
        """Frames that wait for it."""
        self._behind_since: float | None = None
        self._notices: dict[object, Message] = {}
        """By what makes a later one replace an earlier one, in the order in which they are told."""
        self._numbers = 0
        self._next_state_at = -float("inf")
        self._told: State | None = None
        """The last one, from which it can follow by what has changed."""

    def watches(self, now: float) -> bool:
        """Whether frames are wanted: it can be seen, takes them, and said its size or had the time to."""
        settled = self.size is not None or now - self._joined_at >= SETTLING_SECONDS
        return self.visible and settled and not self.credit.stalled(now)

    def resize(self, width: int, height: int) -> None:
        """The size it would like, in pixels."""
        self.size = (width, height)

    def show(self, visible: bool, now: float) -> None:
        """It can, or cannot, be seen."""
        if visible and not self.visible:
            self.watching_since = now
        if not visible:
            self.feed.fall_out()
        self.visible = visible
        self.wake.set()

    def dismiss(self, standing: Literal[Standing.DISMISSED, Standing.STOPPING] = Standing.DISMISSED) -> None:
        """End the stream."""
        if self.standing is Standing.ATTENDING:
            self.standing = standing
        self.wake.set()

    def acknowledge(self, sequence: int, now: float) -> None:
        """It showed the frame of that number."""
        self.credit.acknowledge(sequence, now)
        self.wake.set()

    def offer(self, frame: Frame, message: bytes, now: float, stream: Stream = Codec.JPEG) -> None:
        """The session's latest frame; a picture of its own that it was offered before and has not taken is forgotten.
        `stream`: by whose topic it came, JPEG being that of pictures of their own."""
        self.feed.offer(frame, message, stream, now)
        self.wake.set()

    def restart(self) -> None:
        """Another engine may give a number of the one before to another frame. What is in flight stays so."""
        self.feed.restart()

    def tell(self, notice: Notice) -> None:
        """Queue a notice. Of those that say how something is, only the latest waits; of equal ones, only one."""
        key: object
        match notice:
            case State() | Change() | Snapshot() | Viewers() | Engine() | Leaving():
                key = type(notice)
            case Problem():
                key = notice
            case Pong() | Hello() | Picked() | Outlined() | Reached():
                self._numbers += 1
                key = self._numbers
            case _:
                assert_never(notice)
        self._notices.pop(key, None)
        self._notices[key] = notice
        if len(self._notices) > NOTICES_WAITING and self.standing is Standing.ATTENDING:
            self.standing = Standing.OVERRUN
        self.wake.set()

    def next_notice(self, now: float) -> Message | None:
        """The oldest notice that may be told now, taken from the queue."""
        for key, notice in self._notices.items():
            if isinstance(notice, State):
                if now < self._next_state_at and self.standing is Standing.ATTENDING:
                    continue
                self._next_state_at = now + STATE_SECONDS
            del self._notices[key]
            return self._since_told(notice) if isinstance(notice, State) else notice
        return None

    def _since_told(self, state: State) -> State | Change:
        """What is new of a state to this viewer, which is then told."""
        told, self._told = self._told, state
        if told is None:
            return state
        motions = None if state.motions == told.motions else state.motions
        same = state.model_dump(include={"revision", *Fall.model_fields})
        return Change(since=told.revision, parts=changed_parts(told.scene, state.scene), motions=motions, **same)

    def next_frame(self, now: float) -> bytes | None:
        """The latest frame if it is new to the viewer and there is credit for it; that is then used."""
        waiting = self.feed.next
        if waiting is None or not self.visible or not self.credit.available(len(waiting.message), now):
            return None
        sequence, message, _ = self.feed.take()
        self.credit.take(sequence, len(message), now)
        return message

    def behind(self, now: float) -> float | None:
        """s since when video waits for this viewer's link; None if none does."""
        waiting = self.feed.next
        video = waiting is not None and waiting.is_video and self.visible
        if not video or waiting is None or self.credit.available(len(waiting.message), now):
            self._behind_since = None
        elif self._behind_since is None:
            self._behind_since = now
        return self._behind_since

    def rate(self, now: float) -> float:
        """Frames per second that it can take now."""
        return self.credit.rate(now) if self.watches(now) else 0.0

    def sleep_until(self) -> float | None:
        """When a notice may be told that has to wait until then; None if only `wake` brings something to send."""
        return self._next_state_at if State in self._notices else None
