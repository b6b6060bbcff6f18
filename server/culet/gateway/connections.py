"""Connections: how many there may be, of all and of each address, and what each owes its server.

A head has so many seconds, a body and the reading of an answer must make progress. Where there is no room for one more,
the connection that has kept the server waiting longest goes, of the address that holds most: what half-sent requests
hold is always there for the next visitor. Requests that are being answered, and streams, are never ended for that.
"""

from __future__ import annotations

import asyncio
import logging
import resource
from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import Enum, auto
from http import HTTPStatus
from ipaddress import ip_address
from typing import Any

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

from culet.gateway.bucket import Bucket
from culet.gateway.client_address import Network, client_at
from culet.gateway.paced_stream import PacedStream
from culet.gateway.problems import RETRY_AFTER_SECONDS, problem
from culet.gateway.settings import GatewaySettings
from culet.gateway.turns import EVENTS_PER_SECOND, TurnedConnection, Turns

log = logging.getLogger(__name__)

LOOK_SECONDS = 0.5
"""Between looks at what connections owe."""
PROGRESS_SECONDS = 10.0
"""A body must have made its progress within each span of so long."""
UNREAD_SECONDS = 60.0
"""The same for the reading of an answer. A kernel whose buffer was full tells of room only when a sixteenth of it is
free again, up to 400 kB: at 10 kB/s, after 40 s."""
LINGER_SECONDS = 5.0
"""After an answer that did not wait for the whole body: for the rest of the body, so that the answer is read."""
RESERVED_FILES = 288
"""File descriptors that are not for connections: ZeroMQ's, the page's files, logs, and connections just accepted."""
FEWEST_CONNECTIONS = 16


class Phase(Enum):
    """What a connection is waiting for."""

    HEAD = auto()
    """For a request: nothing has come, or a part of its head."""
    BODY = auto()
    """For the rest of a request's body."""
    LINGER = auto()
    """For the rest of a body whose request is answered already."""
    ANSWER = auto()
    """For the application, or for the client to read the answer."""
    STREAM = auto()
    """For nothing: it is a WebSocket, which looks after itself."""


WAITING = (Phase.HEAD, Phase.BODY, Phase.LINGER)
"""The server waits for the client."""


@dataclass(eq=False)
class Connection:
    """One connection, as the guard knows it."""

    protocol: GuardedHttp
    address: str | None
    """The client; None for a trusted proxy, whose connections are many clients'."""
    since: float
    """When its phase began."""
    phase: Phase = Phase.HEAD
    looked: float = 0.0
    """When its progress was looked at last."""
    received: int = 0
    """Bytes since then."""
    unread: int = 0
    """Bytes of the answer that waited for the client to take them then."""
    taken: int = 0
    """Bytes that it had taken, of all answers."""
    partial: bool = False
    """Whether something of a head has come."""

    def enter(self, phase: Phase, now: float) -> None:
        """The phase that it is in now."""
        if phase is not self.phase:
            self.phase = phase
            self.since = self.looked = now
            self.received = self.unread = 0


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
        self._connections: dict[asyncio.BaseTransport, Connection] = {}
        self._of_address: Counter[str | None] = Counter()

    def __len__(self) -> int:
        return len(self._connections)

    def admit(self, protocol: GuardedHttp, host: str | None, now: float) -> Connection | None:
        """A new connection, or None if there is no room for it, not even by ending others."""
        address = None if self._is_proxy(host) else client_at(host)
        if address is not None and self._of_address[address] >= self.limit_of_address:
            if not self._make_room(address):
                return None
        elif len(self) >= self.limit and not self._make_room():
            return None
        connection = Connection(protocol, address, now, looked=now)
        self._connections[protocol.transport] = connection
        self._of_address[address] += 1
        return connection

    def forget(self, transport: asyncio.BaseTransport) -> None:
        """A connection is gone."""
        connection = self._connections.pop(transport, None)
        if connection is not None:
            self._of_address[connection.address] -= 1
            if not self._of_address[connection.address]:
                del self._of_address[connection.address]

    async def run(self) -> None:
        """Look after the connections until cancelled."""
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(LOOK_SECONDS)
            now = loop.time()
            for connection in list(self._connections.values()):
                self._look(connection, now)

    def _look(self, connection: Connection, now: float) -> None:
        protocol, waited = connection.protocol, now - connection.since
        if connection.phase is Phase.ANSWER:  # nothing tells when the client has read it
            protocol.tell()
        match connection.phase:
            case Phase.HEAD if waited > self.head_seconds:
                if connection.partial:
                    self._end(connection, f"expected a request's head within {self.head_seconds:g} s")
                else:
                    self._end(connection)
            case Phase.LINGER if waited > LINGER_SECONDS:
                self._end(connection)
            case Phase.BODY if protocol.flow.read_paused:  # the client may not send
                connection.looked, connection.received = now, 0
            case Phase.BODY if now - connection.looked > PROGRESS_SECONDS:
                if connection.received < self.min_bytes:
                    rate = self.min_bytes / PROGRESS_SECONDS
                    self._end(connection, f"expected at least {rate:g} bytes of the body a second")
                connection.looked, connection.received = now, 0
            case Phase.ANSWER if now - connection.looked > UNREAD_SECONDS:
                unread = protocol.transport.get_write_buffer_size()
                taken = protocol.written() - unread
                if connection.unread and taken - connection.taken < min(self.min_bytes, connection.unread):
                    self._end(connection)
                connection.looked, connection.unread, connection.taken = now, unread, taken
            case _:
                pass

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

    def _largest_group(self, connections: Iterable[Connection]) -> list[Connection]:
        groups: dict[str | None, list[Connection]] = {}
        for connection in connections:
            groups.setdefault(connection.address, []).append(connection)
        return max(groups.values(), key=len, default=[])

    def _end(self, connection: Connection, why: str | None = None) -> None:
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


def connection_limit(wanted: int) -> int:
    """How many connections there may be: those wanted, as far as the limit of open files, raised if need be, goes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = wanted + RESERVED_FILES
    if soft != resource.RLIM_INFINITY and soft < needed:
        soft = needed if hard == resource.RLIM_INFINITY else min(needed, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        if soft < needed:
            log.warning("the limit of open files, %d, leaves room for %d connections", soft, soft - RESERVED_FILES)
            return max(FEWEST_CONNECTIONS, soft - RESERVED_FILES)
    return wanted


class GuardedConfig(uvicorn.Config):
    """uvicorn's configuration with the guard, which its protocols are made with."""

    def __init__(self, app: Any, guard: Guard, **options: Any) -> None:  # noqa: ANN401 - as uvicorn's own
        super().__init__(app, http=GuardedHttp, ws=GuardedStream, **options)
        self.guard = guard


class GuardedHttp(H11Protocol):
    """uvicorn's HTTP/1.1, which tells the guard what it waits for."""

    config: GuardedConfig
    conn: TurnedConnection
    cycle: RequestResponseCycle | None  # type: ignore[assignment]  # there is none before the first request
    connection: Connection | None = None
    _waits = False
    """For its next turn."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - as uvicorn's
        super().__init__(*arguments, **options)
        self.conn = TurnedConnection(self.config.guard.turns)
        self._events = Bucket(EVENTS_PER_SECOND)

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as in uvicorn's
        """Let it in, or close it at once."""
        super().connection_made(_LingeringTransport(transport, self))
        self.connection = self.config.guard.admit(self, self.client[0] if self.client else None, self.loop.time())
        if self.connection is None:
            self.refuse(503, "at the limit", "this server has as many connections as it takes; try again later")

    def data_received(self, data: bytes) -> None:
        """Bytes of a request."""
        if self.connection is None or self.transport.is_closing():
            return
        self.connection.received += len(data)
        if self.connection.phase is Phase.HEAD and not self.connection.partial:
            self.connection.partial, self.connection.since = True, self.loop.time()
        super().data_received(data)
        self.tell()

    def handle_events(self) -> None:
        """As many as it may have in this turn of the loop; meanwhile no more is read."""
        if self._waits:
            return
        self.conn.begin()
        super().handle_events()
        now = self.loop.time()
        self._events.spend(self.conn.given, now)
        if self.conn.has_more and not self.transport.is_closing():
            self._waits = True
            self.loop.call_later(self._events.overdrawn_for(now), self.config.guard.turns.wait, self)
        self._lingering().hold(self._waits)

    def go_on(self) -> None:
        """It is its turn again."""
        self._waits = False
        if not self.transport.is_closing():
            self.handle_events()
            self.tell()

    def on_response_complete(self) -> None:
        """The answer is with the transport."""
        super().on_response_complete()
        self.tell()

    def connection_lost(self, exc: Exception | None) -> None:
        """It is gone."""
        self.config.guard.forget(self.transport)
        self.config.guard.turns.forget(self)
        super().connection_lost(exc)

    def _should_upgrade(self) -> bool:
        """Whether this is a WebSocket's opening (RFC 6455, 4.1); anything else that says `Upgrade` is plain HTTP.

        uvicorn would wait for ever for the rest of an opening that has a body.
        """
        names = {name for name, _ in self.headers}
        has_body = bool(names & {b"content-length", b"transfer-encoding"})
        is_opening = self.scope["method"] == "GET" and b"sec-websocket-key" in names and not has_body
        return is_opening and super()._should_upgrade()

    def _unsupported_upgrade_warning(self) -> None:
        """Anybody can ask for h2c."""

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """It becomes a stream."""
        if self.connection is not None:
            self.connection.enter(Phase.STREAM, self.loop.time())
        super().handle_websocket_upgrade(event)

    def send_400_response(self, msg: str) -> None:
        """For what is not HTTP."""
        self.refuse(400, "bad request", "expected an HTTP/1.1 request")

    def refuse(self, status: int, title: str, detail: str) -> None:
        """Answer by a problem document, unless an answer has begun, and close."""
        if self.cycle is not None and not self.cycle.response_complete:
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            later = {"Retry-After": RETRY_AFTER_SECONDS} if status == HTTPStatus.SERVICE_UNAVAILABLE else None
            answer = problem(status, title, detail, headers=later)
            headers = [*answer.raw_headers, (b"connection", b"close")]
            head = h11.Response(status_code=status, headers=headers, reason=HTTPStatus(status).phrase.encode())
            for event in (head, h11.Data(data=bytes(answer.body))):
                self.transport.write(self.conn.send(event) or b"")
            self.transport.write(self.conn.send(h11.EndOfMessage()) or b"")
        self.transport.close()
        self.loop.call_later(LINGER_SECONDS, self.transport.abort)  # if the client does not read even that

    def written(self) -> int:
        """Bytes of answers that the transport was given."""
        return self._lingering().written

    def _lingering(self) -> _LingeringTransport:
        assert isinstance(self.transport, _LingeringTransport)  # noqa: S101 - by `connection_made`
        return self.transport

    def is_sending(self) -> bool:
        """Whether the client is in the middle of a body."""
        return self.conn.their_state is h11.SEND_BODY and not self.conn.they_are_waiting_for_100_continue

    def tell(self) -> None:
        """Tell the guard in which phase the connection is."""
        if self.connection is None or self.connection.phase is Phase.STREAM:
            return
        answered = self.cycle is None or self.cycle.response_complete
        their_state = self.conn.their_state
        if their_state is h11.SEND_BODY:
            phase = Phase.LINGER if answered else Phase.BODY
        elif their_state is h11.IDLE and answered and not self.transport.get_write_buffer_size():
            phase = Phase.HEAD
            if self.connection.phase is not Phase.HEAD:
                self.connection.partial = bool(self.conn.trailing_data[0])
        else:
            phase = Phase.ANSWER
        self.connection.enter(phase, self.loop.time())


class _LingeringTransport(asyncio.Transport):
    """A transport that closes only its own direction while the client sends a body that nobody waits for any more.

    What comes for a closed socket is answered by a reset, and with that the client loses the answer too.
    """

    def __init__(self, transport: asyncio.Transport, protocol: GuardedHttp) -> None:
        super().__init__()
        self._transport = transport
        self._protocol = protocol
        self._lingering = False
        self._paused = self._held = False
        self.written = 0

    def close(self) -> None:
        if self._lingering or self._transport.is_closing() or not self._protocol.is_sending():
            self._transport.close()
            return
        self._lingering = True
        self._held = False
        self.resume_reading()
        self._transport.write_eof()
        asyncio.get_running_loop().call_later(LINGER_SECONDS, self._transport.abort)

    def is_closing(self) -> bool:
        return self._lingering or self._transport.is_closing()

    def abort(self) -> None:
        self._transport.abort()

    def write(self, data: bytes | bytearray | memoryview[Any]) -> None:
        if not self._lingering:
            self.written += len(data)
            self._transport.write(data)

    def write_eof(self) -> None:
        self._transport.write_eof()

    def can_write_eof(self) -> bool:
        return self._transport.can_write_eof()

    def pause_reading(self) -> None:
        self._paused = True
        self._transport.pause_reading()

    def resume_reading(self) -> None:
        self._paused = False
        if not self._held:
            self._transport.resume_reading()

    def hold(self, held: bool) -> None:
        """Read nothing for now, whoever wants to."""
        self._held = held
        if held:
            self._transport.pause_reading()
        elif not self._paused:
            self._transport.resume_reading()

    def is_reading(self) -> bool:
        return self._transport.is_reading()

    def get_write_buffer_size(self) -> int:
        return self._transport.get_write_buffer_size()

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        self._transport.set_write_buffer_limits(high, low)

    def get_extra_info(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 - as the transport's
        return self._transport.get_extra_info(name, default)

    def set_protocol(self, protocol: asyncio.BaseProtocol) -> None:
        self._transport.set_protocol(protocol)

    def get_protocol(self) -> asyncio.BaseProtocol:
        return self._transport.get_protocol()


class GuardedStream(PacedStream):
    """A WebSocket, which the guard counts too."""

    config: GuardedConfig

    def connection_lost(self, exc: Exception | None) -> None:
        """It is gone."""
        self.config.guard.forget(self.transport)
        super().connection_lost(exc)
