"""How many sessions there may be, of all and of each client, and which one makes room for another."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Awaitable, Callable, Mapping, Sequence

from culet.errors import BusyError
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.settings import GatewaySettings

RELOAD_SECONDS = 10.0
"""A session that was watched so shortly ago makes no room for others: its page is being loaded anew."""
UNUSED_SECONDS = 60.0
"""A session that was left alone for so long makes room for another one of the client that opened it."""


class SessionPlaces:
    """Within the limits of the settings."""

    def __init__(
        self,
        settings: GatewaySettings,
        records: Mapping[str, SessionRecord],
        close: Callable[[SessionRecord, str], Awaitable[None]],
        watched_elsewhere: Callable[[SessionRecord], Awaitable[bool]],
    ) -> None:
        """`records` are all sessions, `close` ends one and says why."""
        self._settings = settings
        self._records = records
        self._close = close
        self._watched_elsewhere = watched_elsewhere

    async def make_room(self, new: SessionRecord) -> None:
        """Close what others need less than the new session is needed, until all are within the limits; BusyError."""
        while (held := self._of(new.owner)) and len(held) > self._settings.max_client_sessions:
            unused = time.monotonic() - UNUSED_SECONDS
            if not await self._close_one([one for one in held if one is not new and one.used < unused]):
                raise BusyError(f"{new.owner} has {len(held) - 1} sessions open, which is the limit for one client")
        while len(self._records) > self._settings.max_sessions:
            owners = Counter(session.owner for session in self._records.values())
            richest, most = owners.most_common(1)[0]
            if most <= owners[new.owner] or not await self._close_one(self._of(richest)):
                raise BusyError(f"there are {len(self._records) - 1} sessions, which is the limit")

    def _of(self, client: str) -> list[SessionRecord]:
        return [session for session in self._records.values() if session.owner == client]

    async def _close_one(self, sessions: Sequence[SessionRecord]) -> bool:
        """Close the session that is missed least, those never watched first; False if all are in use."""
        for session in sorted(sessions, key=lambda session: (session.watched, session.used)):
            needed = session.viewers or session.asked
            if needed or time.monotonic() - session.viewer_left < RELOAD_SECONDS:
                continue
            if await self._watched_elsewhere(session) or session.viewers or session.asked:
                continue
            await self._close(session, "others needed room; open a new session")
            return True
        return False
