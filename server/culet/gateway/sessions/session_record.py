"""What the gateway knows of one session: enough to show it to viewers, and to give it to another engine."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

from culet.gateway.identity.client_address import UNKNOWN
from culet.gateway.viewers.tiers import StreamTiers
from culet.gateway.viewers.viewer import Viewer
from culet_protocol.engine import SessionChange
from culet_protocol.frame import Frame
from culet_protocol.messages import Condition, Notice, Snapshot, State, balance_rate
from culet_protocol.parts import with_parts
from culet_protocol.sizes import LIVE_SIZE
from culet_protocol.watch import STREAMS, Stream, topic_of, watch_key

SNAPSHOT_BYTES_PER_SECOND = 4000
"""To one viewer. A session of one stone has some 900 bytes, told once a second; larger ones are told more rarely."""
EVENTS_UNDER_WAY = 8
"""Events of one session that the engine has not answered; more events wait with their senders."""


class LesserWanted(NamedTuple):
    """What those viewers can take who are sent lesser pictures."""

    size: tuple[int, int]
    """Pixels."""
    bytes_per_frame: int
    """Of a moving one, as for the others."""
    bytes_at_rest: int
    """Of a picture at rest."""


class Wanted(NamedTuple):
    """What the viewers of a session can take."""

    frames_per_second: float
    """0 if nobody watches."""
    size: tuple[int, int]
    """Pixels."""
    bytes_per_frame: int | None
    """Of a moving one, if frames come as often as the session's balance asks for; None: as many as one likes."""
    bytes_at_rest: int | None
    """Of a picture at rest."""
    lesser: LesserWanted | None = None
    """Of lesser pictures; None if nobody is to have any."""


NO_DEMAND = Wanted(0.0, LIVE_SIZE, None, None)


class SessionRecord:
    """One session; its truth is in the engine, this is the last that was heard of it."""

    def __init__(self, session: str, scene: dict[str, Any], owner: str = UNKNOWN) -> None:
        self.id = session
        self.owner = owner
        """The client that opened it."""
        self.topic = watch_key(session)
        """Its watch id, by which frames come."""
        self.topics: dict[Stream, bytes] = {stream: topic_of(self.topic, stream) for stream in STREAMS}
        """By which frames come that are pictures of their own (JPEG), video, and lesser pictures."""
        self.tiers = StreamTiers()
        self.scene = scene
        self.revision: int | None = None
        """Of the scene, by the engine's count; None until the engine has said so."""
        self.engine: str | None = None
        """Instance of the engine's process that has it."""
        self.findings: tuple[str, ...] = ()
        """What the engine said about the stones when it last described the session."""
        self.condition = Condition(falling=False)
        self.snapshot: dict[str, Any] | None = None
        self.snapshot_told: dict[str, Any] | None = None
        self.next_snapshot_at = -float("inf")
        self.viewers: list[Viewer] = []
        self.latest: tuple[Frame, bytes] | None = None
        """The last frame that came, if it is a picture of its own."""
        self.used = time.monotonic()
        self.asked = 0
        """Requests about it that are not answered."""
        self.watched = False
        """Whether anybody ever watched it, or had a picture of it."""
        self.viewer_left = -float("inf")
        self.viewers_told = 0
        """How many of them the viewers were last told of."""
        self.subscribed: frozenset[Stream] = frozenset()
        """Of whose topics frames are received."""
        self.held: frozenset[Stream] = frozenset()
        """Video that the engine was told to hold."""
        self.key_asked_at = -float("inf")
        """s, when a key frame was asked for last."""
        self.demand = NO_DEMAND
        """What the engine was last told."""
        self.drawn_size: tuple[int, int] | None = None
        """Pixels of the pictures that the engine makes, by its answer; None: it has given none."""
        self.lesser_told = False
        """Whether the engine has confirmed that it knows what lesser pictures may have."""
        self.demanding: asyncio.Task[None] | None = None
        """Tells the engine, one demand after the other."""
        self.room = asyncio.Semaphore(EVENTS_UNDER_WAY)
        """Held for each event until the engine has answered."""

    @contextmanager
    def awaited(self) -> Iterator[None]:
        """Somebody waits for an answer about it, which counts as using it until then."""
        self.asked += 1
        try:
            yield
        finally:
            self.asked -= 1
            self.used = time.monotonic()

    def learn(self, described: Mapping[str, Any]) -> None:
        """What the engine said of the session, as it is now."""
        self.revision, self.scene, self.snapshot = described["revision"], described["scene"], described["snapshot"]
        self.findings = tuple(described["findings"])
        self.condition = Condition.model_validate({name: described[name] for name in Condition.model_fields})

    def hear(self, change: SessionChange) -> bool:
        """What the engine told of the session unasked; False, and nothing learnt, if it is not all that is new."""
        if change.since != self.revision:
            return False
        self.revision, self.scene = change.revision, with_parts(self.scene, change.parts)
        self.snapshot = (self.snapshot or {}) | change.moved
        self.condition = Condition.model_validate(change.model_dump(include=set(Condition.model_fields)))
        return True

    def tell_snapshot(self, now: float) -> None:
        """Tell the viewers the snapshot, if it is another one and they can do with it now."""
        if self.snapshot is self.snapshot_told or self.snapshot is None or now < self.next_snapshot_at:
            return
        notice = Snapshot(snapshot=self.snapshot)
        size = len(notice.model_dump_json())
        self.snapshot_told, self.next_snapshot_at = self.snapshot, now + max(1.0, size / SNAPSHOT_BYTES_PER_SECOND)
        for viewer in self.viewers:
            if viewer.steers:  # who only watches cannot have the session made again
                viewer.tell(notice)

    def state(self) -> State:
        """The notice for viewers, of which each is told what is new to it."""
        return State(revision=self.revision or 0, scene=self.scene, **self.condition.model_dump())

    def codecs_wanted(self, now: float) -> frozenset[Stream]:
        """Of frames that those who watch need; JPEG: pictures of their own."""
        watching = [viewer.feed.codecs for viewer in self.viewers if viewer.watches(now)]
        return frozenset().union(*watching)

    def tell(self, notice: Notice) -> None:
        """Tell every viewer."""
        for viewer in self.viewers:
            viewer.tell(notice)

    def wanted(self, now: float) -> Wanted:
        """Frames per second that some viewer can take; the size that the one who has watched longest asked for, of
        those who steer if there are any, and the bytes for which that one's link has room."""
        watching = [viewer for viewer in self.viewers if viewer.watches(now)]
        rate = max((viewer.rate(now) for viewer in watching), default=0.0)
        deciding = self._deciding(watching)
        if deciding is None:
            return NO_DEMAND
        credit, size, asked = deciding.credit, deciding.size or self.demand.size, balance_rate(self.condition.exactness)
        lesser = None
        if least := [viewer for viewer in watching if viewer.feed.lesser]:
            sizes = [viewer.size or size for viewer in least]
            lesser = LesserWanted(
                (max(width for width, _ in sizes), max(height for _, height in sizes)),
                min(viewer.credit.bytes_per_frame(asked, now) for viewer in least),
                min(viewer.credit.bytes_at_rest(now) for viewer in least),
            )
        return Wanted(rate, size, credit.bytes_per_frame(asked, now), credit.bytes_at_rest(now), lesser)

    def assign_tiers(self, now: float) -> None:
        """See to it that each viewer is sent frames for which it has room."""
        watching = [viewer for viewer in self.viewers if viewer.watches(now)]
        self.tiers.assign(watching, self._deciding(watching), self.drawn_size or self.demand.size, now)

    @staticmethod
    def _deciding(watching: Sequence[Viewer]) -> Viewer | None:
        sized = [viewer for viewer in watching if viewer.size]
        sized = [viewer for viewer in sized if viewer.steers] or sized
        return min(sized or watching, key=lambda viewer: viewer.watching_since, default=None)
