"""What the gateway is told unasked of sessions that change by themselves: what another engine would need to go on."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable
from typing import NamedTuple, Self
from weakref import WeakKeyDictionary

from culet.engine.painting.live_picture import LivePicture
from culet.engine.session.session import Session
from culet_protocol.engine import SessionChange, SessionMotion

MOTION_SECONDS = 0.05
"""Between two messages about a session that moves. If this engine dies, so much of the motion is lost at most."""


class _Told(NamedTuple):
    """What changes whenever another engine would have to be told something."""

    step: int = 0
    sequence: int = 0
    sleeping: frozenset[str] = frozenset()
    """Ids of stones."""
    asleep: bool = False
    """All sleep, and nothing moves any more: a step later than when the last one fell asleep."""

    @classmethod
    def of(cls, session: Session) -> Self:
        """As the session is now."""
        sleeping = frozenset(name for name, motion in session.motion.motions().items() if motion == "asleep")
        return cls(session.shown.step, session.sequence, sleeping, session.motion.asleep)


class MotionNews:
    """Of all sessions."""

    def __init__(self, pictures: Iterable[LivePicture], tell: Callable[[SessionChange | SessionMotion], None]) -> None:
        """`pictures` are those that there are at each moment."""
        self._pictures = pictures
        self._tell = tell
        self._told: WeakKeyDictionary[Session, _Told] = WeakKeyDictionary()
        """What of each session was told last."""
        self._telling: set[Session] = set()

    async def run(self) -> None:
        """Tell of every session that has changed by itself, often, until cancelled."""
        async with asyncio.TaskGroup() as tasks:
            while True:
                for session in [live.session for live in self._pictures]:
                    if session not in self._telling and self._told.get(session) != _Told.of(session):
                        self._telling.add(session)
                        tasks.create_task(self._tell_of(session))
                await asyncio.sleep(MOTION_SECONDS)

    async def _tell_of(self, session: Session) -> None:
        try:
            async with session.lock, session.motion.still():
                before, now = self._told.get(session, _Told()), _Told.of(session)
                self._told[session] = now
                if (now.sleeping, now.asleep) != (before.sleeping, before.asleep):
                    self._tell(session.change_told(edited=False))
                else:
                    self._tell(session.motion_told())
        finally:
            self._telling.discard(session)
