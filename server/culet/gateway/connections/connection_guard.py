"""How many connections there may be, of all and of each address, and what each owes its server.

A head has so many seconds, a body and the reading of an answer must make progress. Where there is no room for one more,
the connection that has kept the server waiting longest goes, of the address that holds most: what half-sent requests
hold is always there for the next visitor. Requests that are being answered, and streams, are never ended for that.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Collection, Iterable
from ipaddress import ip_address
from typing import assert_never

from culet.gateway.connections.connection import LINGER_SECONDS, WAITING, Guarded, GuardedConnection, Phase
from culet.gateway.identity.client_address import Network, client_at
from culet.gateway.limits.holdings import Holdings
from culet.gateway.limits.open_files import connection_limit
from culet.gateway.limits.turns import Turns
from culet.gateway.settings import GatewaySettings

log = logging.getLogger(__name__)

LOOK_SECONDS = 0.5
"""Between looks at what connections owe."""
PROGRESS_SECONDS = 10.0
"""A body must have made its progress within each span of so long."""
UNREAD_SECONDS = 60.0
"""The same for the reading of an answer. A kernel whose buffer was full tells of room only when a sixteenth of it is
free again, up to 400 kB: at 10 kB/s, after 40 s."""


class Guard:
    """All connections of one server."""

    def __init__(self, settings: GatewaySettings, proxies: Collection[Network]) -> None:
        self.head_seconds = settings.head_seconds
        self.min_bytes = settings.min_body_rate * PROGRESS_SECONDS
        self.limit = connection_limit(settings.max_connections)
        self.limit_of_address = settings.max_connections_per_address
        self.ended = 0
        """Connections that were ended for others or for owing too long."""
        self.turns = Turns()
        self._proxies = proxies
        self._connections: dict[asyncio.BaseTransport, GuardedConnection] = {}
        self._of_address = Holdings()

    def __len__(self) -> int:
        return len(self._connections)

    def admit(self, protocol: Guarded, host: str | None, now: float) -> GuardedConnection | None:
        """A new connection, or None if there is no room for it, not even by ending others."""
        address = None if self._is_proxy(host) else client_at(host)
        if address is not None and self._of_address.of(address) >= self.limit_of_address:
            if not self._make_room(address):
                return None
        elif len(self) >= self.limit and not self._make_room():
            return None
        connection = GuardedConnection(protocol, address, now, looked=now)
        self._connections[protocol.transport] = connection
        self._of_address.take(address)
        return connection

    def forget(self, transport: asyncio.BaseTransport) -> None:
        """A connection is gone."""
        connection = self._connections.pop(transport, None)
        if connection is not None:
            self._of_address.give_back(connection.address)

    async def run(self) -> None:
        """Look after the connections until cancelled."""
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(LOOK_SECONDS)
            now = loop.time()
            for connection in list(self._connections.values()):
                self._look(connection, now)

    def _look(self, connection: GuardedConnection, now: float) -> None:
        protocol, waited = connection.protocol, now - connection.since
        if connection.phase is Phase.ANSWER:  # nothing tells when the client has read it
            protocol.tell()
        match connection.phase:
            case Phase.HEAD:
                if waited > self.head_seconds:
                    late = f"expected a request's head within {self.head_seconds:g} s"
                    self._end(connection, late if connection.partial else None)
            case Phase.BODY:
                self._look_at_body(connection, now)
            case Phase.LINGER:
                if waited > LINGER_SECONDS:
                    self._end(connection)
            case Phase.ANSWER:
                if now - connection.looked > UNREAD_SECONDS:
                    self._look_at_reading(connection, now)
            case Phase.STREAM:
                pass
            case _:
                assert_never(connection.phase)

    def _look_at_body(self, connection: GuardedConnection, now: float) -> None:
        if not connection.protocol.may_read:
            connection.looked, connection.received = now, 0
        elif now - connection.looked > PROGRESS_SECONDS:
            if connection.received < self.min_bytes:
                rate = self.min_bytes / PROGRESS_SECONDS
                self._end(connection, f"expected at least {rate:g} bytes of the body a second")
            connection.looked, connection.received = now, 0

    def _look_at_reading(self, connection: GuardedConnection, now: float) -> None:
        unread = connection.protocol.transport.get_write_buffer_size()
        taken = connection.protocol.written() - unread
        if connection.unread and taken - connection.taken < min(self.min_bytes, connection.unread):
            self._end(connection)
        connection.looked, connection.unread, connection.taken = now, unread, taken

    def _make_room(self, address: str | None = None) -> bool:
        """End the connection that has kept the server waiting longest, of an address or else of the one with most."""
        waiting = [each for each in self._connections.values() if each.phase in WAITING]
        if address is not None:
            waiting = [each for each in waiting if each.address == address]
        else:
            waiting = self._largest_group(waiting)
        if not waiting:
            return False
        self._end(min(waiting, key=lambda each: each.since))
        return True

    def _largest_group(self, connections: Iterable[GuardedConnection]) -> list[GuardedConnection]:
        groups: dict[str | None, list[GuardedConnection]] = {}
        for connection in connections:
            groups.setdefault(connection.address, []).append(connection)
        return max(groups.values(), key=len, default=[])

    def _end(self, connection: GuardedConnection, why: str | None = None) -> None:
        self.ended += 1
        log.debug("ended a connection of %s: %s", connection.address or "a proxy", why or "others need its place")
        self.forget(connection.protocol.transport)
        if why is None:
            connection.protocol.transport.abort()
        else:
            connection.protocol.refuse(408, "request timeout", why)

    def _is_proxy(self, host: str | None) -> bool:
        try:
            address = ip_address((host or "").partition("%")[0])
        except ValueError:
            return False
        mapped = getattr(address, "ipv4_mapped", None)
        return any((mapped or address) in network for network in self._proxies)
