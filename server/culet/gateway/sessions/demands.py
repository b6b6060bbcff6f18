"""What viewers can take, told to the engine: whose frames this gateway listens to, how many and how large they are."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Container

from culet.errors import CuletError, NotFoundError
from culet.gateway.engine.link import EngineLink
from culet.gateway.sessions.session_record import NO_DEMAND, LesserWanted, SessionRecord, Wanted
from culet_protocol.engine import Demand, HoldVideo, LesserDemand
from culet_protocol.frame import Codec
from culet_protocol.sizes import LIVE_SIZE
from culet_protocol.watch import CODEC_OF_VIDEO, VIDEO_NAMES, Lesser, Stream

log = logging.getLogger(__name__)

RATE_CHANGE = 0.2
"""A demand that changes by a smaller part is not worth a message."""
BYTES_CHANGE = 0.05
"""The same of the bytes that frames may have."""
DEMAND_SECONDS = 0.25
"""Between two demands of a session: each size is another picture, begun anew."""
KEY_SECONDS = 1.0
"""Between two key frames of a session that are asked for."""
PATIENCE_SECONDS = 0.25
"""For which those who follow a session's video wait for one whose link is full."""
UNTOLD = Wanted(-1.0, LIVE_SIZE, None, None)
"""A demand unlike any, for an engine that may not have heard the last one."""


class Demands:
    """Of all sessions."""

    def __init__(self, link: EngineLink, known: Container[str]) -> None:
        """`known` has the ids of the sessions that there are."""
        self._link = link
        self._sessions = known
        self._telling: set[asyncio.Task[None]] = set()

    def update(self, session: SessionRecord) -> None:
        """Listen to the session's frames or not, and have the engine told what the viewers can take if it changed."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return
        session.assign_tiers(time.monotonic())
        if session.subscribed and session.wanted(time.monotonic()).frames_per_second <= 0:
            self.forget(session)
        self._listen(session)
        if session.demanding is None or session.demanding.done():
            session.demanding = asyncio.create_task(self._tell_demand(session))

    async def _tell_demand(self, session: SessionRecord) -> None:
        """Until nothing has changed: while one demand is under way only the latest of those after it counts."""
        while (demand := self._new_demand(session)) is not None:
            session.demand = demand
            width, height = demand.size
            told = Demand(
                session=session.id,
                frames_per_second=demand.frames_per_second,
                width=width,
                height=height,
                bytes_per_frame=demand.bytes_per_frame,
                bytes_at_rest=demand.bytes_at_rest,
                lesser=_lesser(demand),
            )
            try:
                answer, _ = await self._link.request(told)
            except CuletError as error:
                known = not isinstance(error, NotFoundError)  # or a new engine is about to be given the session
                log.log(logging.WARNING if known else logging.DEBUG, "demand of a session was refused: %s", error)
                session.demand = UNTOLD
                return  # the next tick tries again
            session.drawn_size = answer["width"], answer["height"]
            session.lesser_told = demand.lesser is not None
            self._listen(session)
            await asyncio.sleep(DEMAND_SECONDS)

    def _listen(self, session: SessionRecord) -> None:
        """To the frames of a session whose viewers want some: the engine, which makes them for who listens, knows by
        now which."""
        if session.demand.frames_per_second <= 0 or session.id not in self._sessions:
            return
        now = time.monotonic()
        wanted = session.codecs_wanted(now)
        if not session.lesser_told:
            wanted -= set(Lesser) - session.subscribed  # which would be made without limits
        wanted = wanted or session.subscribed
        lacking = [viewer for viewer in session.viewers if viewer.feed.lacks_picture and viewer.watches(now)]
        again = wanted & {Codec.JPEG} if lacking else frozenset()
        for codec in (wanted - session.subscribed) | again:
            self._link.subscribe(session.topics[codec])
        for codec in again & session.subscribed:
            self._link.unsubscribe(session.topics[codec])  # it was subscribed to once more, by which the engine knows
        for viewer in lacking if again else ():
            viewer.feed.lacks_picture = False
        for codec in session.subscribed - wanted:
            self._link.unsubscribe(session.topics[codec])
        session.subscribed = wanted

    def heed_video(self, session: SessionRecord) -> None:
        """Frames came, or were taken: see to it that all who follow the session's video can go on doing so."""
        if not session.subscribed.intersection(CODEC_OF_VIDEO) and all(
            viewer.feed.codec is None for viewer in session.viewers
        ):
            return
        now = time.monotonic()
        following = [viewer for viewer in session.viewers if viewer.feed.in_step]
        since = {viewer: viewer.behind(now) for viewer in following}
        behind = [viewer for viewer, at in since.items() if at is not None]
        for viewer in behind:
            others = [other for other in following if other.feed.video is viewer.feed.video and other not in behind]
            if others and now - (since[viewer] or now) > PATIENCE_SECONDS:
                viewer.feed.bar(now)
        waited_for = {viewer.feed.video for viewer in behind if viewer.feed.in_step}
        self._hold(session, session.subscribed.intersection(waited_for))
        self._listen(session)
        lacking = {viewer.feed.video for viewer in session.viewers if viewer.feed.lacks_key and viewer.watches(now)}
        if now - session.key_asked_at >= KEY_SECONDS:
            for codec in session.subscribed.intersection(lacking):
                session.key_asked_at = now
                self._link.subscribe(session.topics[codec])  # once more, by which the engine knows
                self._link.unsubscribe(session.topics[codec])
                for viewer in session.viewers:
                    viewer.feed.lacks_key = False

    def _hold(self, session: SessionRecord, codecs: frozenset[Stream]) -> None:
        """Have the engine hold video of those codecs, and no other."""
        for stream in [stream for stream in CODEC_OF_VIDEO if stream in codecs ^ session.held]:
            codec, lesser = VIDEO_NAMES[CODEC_OF_VIDEO[stream]], isinstance(stream, Lesser)
            told = HoldVideo(session=session.id, codec=codec, held=stream in codecs, lesser=lesser)
            task = asyncio.create_task(self._tell_hold(told))
            self._telling.add(task)
            task.add_done_callback(self._telling.discard)
        session.held = codecs

    async def _tell_hold(self, told: HoldVideo) -> None:
        try:
            await self._link.request(told)
        except CuletError as error:
            log.debug("video of a session could not be held: %s", error)

    def _new_demand(self, session: SessionRecord) -> Wanted | None:
        """What the engine should be told, if it is worth a message."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return None
        demand, told = session.wanted(time.monotonic()), session.demand
        close = (
            demand.size == told.size
            and (demand.frames_per_second > 0) == bool(session.subscribed)
            and _is_close(demand.frames_per_second, told.frames_per_second, RATE_CHANGE)
            and _is_close(demand.bytes_per_frame, told.bytes_per_frame, BYTES_CHANGE)
            and _is_close(demand.bytes_at_rest, told.bytes_at_rest, BYTES_CHANGE)
            and _is_alike(demand.lesser, told.lesser)
        )
        return None if close else demand

    def forget(self, session: SessionRecord) -> None:
        """Listen to the session's frames no more."""
        for codec in session.subscribed:
            self._link.unsubscribe(session.topics[codec])
        session.subscribed = session.held = frozenset()

    def begin_anew(self, session: SessionRecord) -> None:
        """Another engine has the session, and was told no demand."""
        session.demand, session.held = NO_DEMAND, frozenset()
        session.drawn_size, session.lesser_told = None, False
        self.update(session)


def _lesser(demand: Wanted) -> LesserDemand | None:
    if demand.lesser is None:
        return None
    (width, height), per_frame, at_rest = demand.lesser
    return LesserDemand(width=width, height=height, bytes_per_frame=per_frame, bytes_at_rest=at_rest)


def _is_alike(lesser: LesserWanted | None, told: LesserWanted | None) -> bool:
    """Whether it is not worth a message: the engine needs no limits for pictures that nobody is to have."""
    if lesser is None or told is None:
        return lesser is None
    return (
        lesser.size == told.size
        and _is_close(lesser.bytes_per_frame, told.bytes_per_frame, BYTES_CHANGE)
        and _is_close(lesser.bytes_at_rest, told.bytes_at_rest, BYTES_CHANGE)
    )


def _is_close(value: float | None, told: float | None, share: float) -> bool:
    """Whether it has changed by no more than that share; None is like nothing else."""
    if value is None or told is None:
        return value is told
    return abs(value - told) <= share * told
