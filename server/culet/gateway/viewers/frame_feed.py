"""Frames that wait for one viewer: the latest picture, or the packets of video that follow the one it has. No sockets.

A viewer that follows the session's video needs each packet, in order. Whoever misses one is given pictures of their own
until the next key frame. What waits is never long: the engine is told to hold its encoder while a link is full.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from culet_protocol.frame import Codec, Flags, Frame
from culet_protocol.watch import LESSER, LESSER_VIDEO, VIDEO, Stream

MOST_WAITING = 4
"""Packets: two that were under way when the engine was told to hold, and as many for a gateway that is busy."""
BARRED_SECONDS = 10.0
"""For which a viewer that held up others is given pictures of their own."""


class WaitingFrame(NamedTuple):
    """A frame for a viewer."""

    sequence: int
    message: bytes
    is_video: bool


class FrameFeed:
    """Of one viewer. Times are seconds of any one clock."""

    def __init__(self) -> None:
        self.codec: Codec | None = None
        """Of the video that the viewer decodes; None: it wants pictures of their own."""
        self.lesser = False
        """It is sent lesser pictures, and their video."""
        self.lacks_key = False
        """It was offered a packet that it cannot use: it needs a key frame."""
        self.lacks_picture = False
        """It was sent lesser pictures until now: the frame that it has may be at rest, and is to come anew."""
        self._waiting: deque[WaitingFrame] = deque()
        """Packets in the order of their numbers, and at the end, or alone, a picture of its own."""
        self._taken: int | None = None
        self._follows: int | None = None
        """Number of the packet that the viewer has, or will have, and so can decode the one after."""
        self._barred_until = -float("inf")

    @property
    def in_step(self) -> bool:
        """Whether it follows the session's video."""
        return self._follows is not None

    @property
    def video(self) -> Stream | None:
        """That it follows, or will from the next key frame on; None: it wants pictures of their own."""
        return self.codec if self.codec is None or not self.lesser else LESSER_VIDEO[self.codec]

    @property
    def codecs(self) -> frozenset[Stream]:
        """Of frames that it needs to be offered; JPEG: pictures of their own."""
        video = frozenset() if self.video is None else frozenset({self.video})
        return video if self.in_step else video | {LESSER if self.lesser else Codec.JPEG}

    @property
    def next(self) -> WaitingFrame | None:
        """What goes out next."""
        return self._waiting[0] if self._waiting else None

    def follow(self, codec: Codec | None) -> None:
        """From now on video of that codec, from its next key frame on; or none."""
        self.codec = codec
        self.fall_out()

    def follow_lesser(self, *, lesser: bool) -> None:
        """From now on lesser pictures, or those of the first tier again."""
        if lesser != self.lesser:
            self.fall_out()
            self.lacks_key, self.lacks_picture = False, not lesser
        self.lesser = lesser

    def offer(self, frame: Frame, message: bytes, stream: Stream, now: float) -> None:
        """A frame came: of the session's pictures of their own (JPEG), or of its video in a codec, in which there are
        pictures of their own too. Of a number that it was sent as a picture it decodes no packet."""
        if stream not in self.codecs:
            return
        if frame.codec not in VIDEO:
            self._put(WaitingFrame(frame.sequence, message, is_video=False))
        elif Flags.KEY in frame.flags and frame.sequence != self._taken and now >= self._barred_until:
            self._waiting.clear()
            self._put(WaitingFrame(frame.sequence, message, is_video=True))
            self._follows, self.lacks_key = frame.sequence, False
        elif self._follows == frame.depends_on and self.in_step:
            self._put(WaitingFrame(frame.sequence, message, is_video=True))
            self._follows = frame.sequence
            if len(self._waiting) > MOST_WAITING:
                self.fall_out()
        else:
            self.fall_out()
            self.lacks_key = now >= self._barred_until

    def _put(self, waiting: WaitingFrame) -> None:
        """Behind the packets; a picture that nothing depends on makes room for what is newer."""
        if waiting.sequence == self._taken:
            return
        if self._waiting and not self._waiting[-1].is_video:
            self._waiting.pop()
        self._waiting.append(waiting)

    def take(self) -> WaitingFrame:
        """What goes out next, which does then."""
        taken = self._waiting.popleft()
        self._taken = taken.sequence
        return taken

    def fall_out(self) -> None:
        """It does not follow the video any more, until a key frame comes."""
        if self.in_step:
            self._waiting.clear()
        self._follows = None

    def bar(self, now: float) -> None:
        """It takes video so slowly that others would have to wait: it has pictures of their own for a while."""
        self.fall_out()
        self._barred_until = now + BARRED_SECONDS

    def restart(self) -> None:
        """Another engine begins to count anew."""
        self._waiting.clear()
        self._taken = self._follows = None
