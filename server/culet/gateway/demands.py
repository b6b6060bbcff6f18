"""What viewers can take, told to the engine: whose frames this gateway listens to, how many and how large they are."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Container

from culet.errors import CuletError, NotFoundError
from culet.gateway.link import EngineLink
from culet.gateway.session_record import SessionRecord
from culet_protocol.engine import Demand
from culet_protocol.sizes import LIVE_SIZE

log = logging.getLogger(__name__)

RATE_CHANGE = 0.2
"""A demand that changes by a smaller part is not worth a message."""
DEMAND_SECONDS = 0.25
"""Between two demands of a session: each size is another picture, begun anew."""
UNTOLD = (-1.0, *LIVE_SIZE)
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
        watched = session.wanted(time.monotonic())[0] > 0
        if watched and not session.subscribed:
            self._link.subscribe(session.topic)
        elif session.subscribed and not watched:
            self._link.unsubscribe(session.topic)
        session.subscribed = watched
        if session.demanding is None or session.demanding.done():
            session.demanding = asyncio.create_task(self._tell_demand(session))

    async def _tell_demand(self, session: SessionRecord) -> None:
        """Until nothing has changed: while one demand is under way only the latest of those after it counts."""
        while (demand := self._new_demand(session)) is not None:
            session.demand = demand
            rate, width, height = demand
            try:
                await self._link.request(Demand(session=session.id, frames_per_second=rate, width=width, height=height))
            except CuletError as error:
                known = not isinstance(error, NotFoundError)  # or a new engine is about to be given the session
                log.log(logging.WARNING if known else logging.DEBUG, "demand of a session was refused: %s", error)
                session.demand = UNTOLD
                return  # the next tick tries again
            await asyncio.sleep(DEMAND_SECONDS)

    def _new_demand(self, session: SessionRecord) -> tuple[float, int, int] | None:
        """What the engine should be told, if it is worth a message."""
        if session.id not in self._sessions or not self._link.ready.is_set():
            return None
        demand = rate, *size = session.wanted(time.monotonic())
        told_rate, *told_size = session.demand
        close = (rate > 0) == (told_rate > 0) and abs(rate - told_rate) <= RATE_CHANGE * told_rate
        return None if close and size == told_size else demand

    def forget(self, session: SessionRecord) -> None:
        """Listen to the session's frames no more."""
        if session.subscribed:
            self._link.unsubscribe(session.topic)
            session.subscribed = False

    def begin_anew(self, session: SessionRecord) -> None:
        """Another engine has the session, and was told no demand."""
        session.demand = (0.0, *LIVE_SIZE)
        self.update(session)
