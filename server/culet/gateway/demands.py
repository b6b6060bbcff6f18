"""What viewers can take, told to the engine: whose frames this gateway listens to, how many and how large they are."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Container

from culet.errors import CuletError, NotFoundError
from culet.gateway.link import EngineLink
from culet.gateway.session_record import NO_DEMAND, SessionRecord, Wanted
from culet_protocol.engine import Demand
from culet_protocol.sizes import LIVE_SIZE

log = logging.getLogger(__name__)

RATE_CHANGE = 0.2
"""A demand that changes by a smaller part is not worth a message."""
BYTES_CHANGE = 0.05
"""The same of the bytes that frames may have."""
DEMAND_SECONDS = 0.25
"""Between two demands of a session: each size is another picture, begun anew."""
UNTOLD = Wanted(-1.0, LIVE_SIZE, None, None)
"""A demand unlike any, for an engine that may not have heard the last one."""


class Demands:
    """Of all sessions."""

    def __init__(self, link: EngineLink, known: Container[str]) -> None:
        """`known` has the ids of the sessions that there are."""
        self._link = link
        self._sessions = known

    def update(self, session: SessionRecord) -> None:
        """Listen to the session's frames or not, and have the engine told what the viewers can take if it changed."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return
        if session.subscribed and session.wanted(time.monotonic()).frames_per_second <= 0:
            self.forget(session)
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
            )
            try:
                await self._link.request(told)
            except CuletError as error:
                known = not isinstance(error, NotFoundError)  # or a new engine is about to be given the session
                log.log(logging.WARNING if known else logging.DEBUG, "demand of a session was refused: %s", error)
                session.demand = UNTOLD
                return  # the next tick tries again
            self._listen(session)
            await asyncio.sleep(DEMAND_SECONDS)

    def _listen(self, session: SessionRecord) -> None:
        """To the frames of a session whose viewers want some: the engine, which makes them for who listens, knows by
        now which."""
        if session.demand.frames_per_second > 0 and not session.subscribed and session.id in self._sessions:
            self._link.subscribe(session.topic)
            session.subscribed = True

    def _new_demand(self, session: SessionRecord) -> Wanted | None:
        """What the engine should be told, if it is worth a message."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return None
        demand, told = session.wanted(time.monotonic()), session.demand
        close = (
            demand.size == told.size
            and (demand.frames_per_second > 0) == session.subscribed
            and _is_close(demand.frames_per_second, told.frames_per_second, RATE_CHANGE)
            and _is_close(demand.bytes_per_frame, told.bytes_per_frame, BYTES_CHANGE)
            and _is_close(demand.bytes_at_rest, told.bytes_at_rest, BYTES_CHANGE)
        )
        return None if close else demand

    def forget(self, session: SessionRecord) -> None:
        """Listen to the session's frames no more."""
        if session.subscribed:
            self._link.unsubscribe(session.topic)
            session.subscribed = False

    def begin_anew(self, session: SessionRecord) -> None:
        """Another engine has the session, and was told no demand."""
        session.demand = NO_DEMAND
        self.update(session)


def _is_close(value: float | None, told: float | None, share: float) -> bool:
    """Whether it has changed by no more than that share; None is like nothing else."""
    if value is None or told is None:
        return value is told
    return abs(value - told) <= share * told
