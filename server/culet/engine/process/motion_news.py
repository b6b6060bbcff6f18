"""What the gateway is told unasked of sessions that change by themselves: what another engine would need to go on."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable
from weakref import WeakKeyDictionary

from culet.engine.painting.live_picture import LivePicture
from culet.engine.session.session import Session
from culet_protocol.engine import SessionChange, SessionMotion
from culet_protocol.messages import Condition

log = logging.getLogger(__name__)

MOTION_SECONDS = 0.05
"""Between two messages about a session that moves. If this engine dies, so much of the motion is lost at most."""


class MotionNews:
    """Of all sessions."""

    def __init__(self, pictures: Iterable[LivePicture], tell: Callable[[SessionChange | SessionMotion], None]) -> None:
        """`pictures` are those that there are at each moment."""
        self._pictures = pictures
        self._tell = tell
        self._told: WeakKeyDictionary[Session, tuple[int, int, Condition]] = WeakKeyDictionary()
        """How each session was when it was told of last: whenever it is otherwise, another engine would need that."""
        self._telling: set[Session] = set()

    async def run(self) -> None:
        """Tell of every session that has changed by itself, often, until cancelled."""
        async with asyncio.TaskGroup() as tasks:
            while True:
                for session in [live.session for live in self._pictures]:
                    if session not in self._telling and self._told.get(session) != _now(session):
                        self._telling.add(session)
                        tasks.create_task(self._tell_of(session))
                await asyncio.sleep(MOTION_SECONDS)

    async def _tell_of(self, session: Session) -> None:
        try:
            async with session.motion.still():
                self._told[session] = _now(session)
                if session.condition() != session.news.condition:
                    self._tell(session.change_told(edited=False))
                else:
                    self._tell(session.motion_told())
        except Exception:  # one session's failure must not end the others'
            log.exception("what a session is like could not be told")
        finally:
            self._telling.discard(session)


def _now(session: Session) -> tuple[int, int, Condition]:
    return session.shown.step, session.sequence, session.condition()
