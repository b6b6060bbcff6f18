"""Which viewers of a session are sent its lesser pictures: those whose link, or whose window if they take no video, has
less than half of the room that the frames need which the deciding viewer gets. Without such viewers the engine makes no
lesser pictures.

Nobody waits for a slow viewer: a frame that its link does not carry in time is not sent to it. But of large frames such
a link carries few. No sockets and no clock here.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from weakref import WeakSet

from culet.gateway.viewers.viewer import Viewer
from culet_protocol.frame import Codec
from culet_protocol.watch import Lesser, Stream

ENTER, LEAVE = 0.5, 0.8
"""Of the bytes a second that frames have: a viewer whose link carries less is sent lesser ones, until it carries more.
Between the two lies what one measures of a link that does not change."""
ENTER_SECONDS, LEAVE_SECONDS = 1.0, 2.0
"""For which that must be so: what is known of a link in its first moments is little."""
SMALL, LARGE = 0.5, 0.6
"""The same of the window of a viewer that takes no video, by its part of the frame's width or height, whichever is
larger: the frame may be cut off."""
COUNTED_SECONDS = 1.0
FEW_FRAMES = 5
"""Of so many in COUNTED_SECONDS nobody is short: they are of a picture at rest."""


class StreamTiers:
    """Of one session. Times are seconds of any one clock."""

    def __init__(self) -> None:
        self._came: dict[Stream, deque[tuple[float, int]]] = {}
        """When frames came, and their bytes, of COUNTED_SECONDS."""
        self._so_since: dict[Viewer, float] = {}
        """Since when viewers should be on the other tier."""
        self._slow: WeakSet[Viewer] = WeakSet()
        """Those who are sent lesser pictures for their link's sake, whatever their window is."""

    def came(self, stream: Stream, size: int, now: float) -> None:
        """A frame of so many bytes came from the engine."""
        if isinstance(stream, Lesser):
            return
        came = self._came.setdefault(stream, deque())
        came.append((now, size))
        _forget(came, now)

    def assign(self, viewers: Sequence[Viewer], deciding: Viewer | None, size: tuple[int, int], now: float) -> None:
        """Have each viewer follow what suits it; the frames are `size` pixels large."""
        for viewer in viewers:
            if viewer is deciding or len(viewers) < 2:
                self._so_since.pop(viewer, None)
                self._follow(viewer, lesser=False)
                continue
            slow, small = self._is_slow(viewer, now), self._is_small(viewer, size)
            lesser = slow or small
            if lesser == viewer.feed.lesser:
                self._so_since.pop(viewer, None)
            elif now - self._so_since.setdefault(viewer, now) >= (ENTER_SECONDS if lesser else LEAVE_SECONDS):
                del self._so_since[viewer]
                self._follow(viewer, lesser=lesser)
            if slow and viewer.feed.lesser:
                self._slow.add(viewer)
            elif small:
                self._slow.discard(viewer)
        for gone in self._so_since.keys() - set(viewers):
            del self._so_since[gone]

    def _follow(self, viewer: Viewer, *, lesser: bool) -> None:
        viewer.feed.follow_lesser(lesser=lesser)
        if not lesser:
            self._slow.discard(viewer)

    @staticmethod
    def _is_small(viewer: Viewer, size: tuple[int, int]) -> bool:
        if viewer.size is None or viewer.feed.codec is not None:  # small pictures have more bytes than large video
            return False
        part = max(viewer.size[0] / size[0], viewer.size[1] / size[1])
        return part < (LARGE if viewer.feed.lesser else SMALL)

    def _is_slow(self, viewer: Viewer, now: float) -> bool:
        needed, carried = self._bytes_per_second(viewer, now), viewer.credit.bytes_per_second(now)
        if needed is None or carried is None:
            return viewer in self._slow
        if viewer in self._slow:
            return carried < LEAVE * needed
        return carried < ENTER * needed and viewer.credit.was_short(now)

    def _bytes_per_second(self, viewer: Viewer, now: float) -> float | None:
        """Of the frames that the viewer gets, or would get, on the first tier; None if nothing moves."""
        counted = []
        for came in self._came.values():
            _forget(came, now)
        for stream in (viewer.feed.codec or Codec.JPEG, *self._came):
            came = self._came.get(stream, deque())
            if len(came) >= FEW_FRAMES:
                counted.append(sum(size for _, size in came) / COUNTED_SECONDS)
        return counted[0] if counted else None


def _forget(came: deque[tuple[float, int]], now: float) -> None:
    while came and now - came[0][0] > COUNTED_SECONDS:
        came.popleft()
