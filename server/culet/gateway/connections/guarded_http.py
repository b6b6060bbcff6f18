"""uvicorn's protocols, which tell the guard of connections what each connection waits for."""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from typing import Any

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

from culet.gateway.answers.problems import RETRY_AFTER_SECONDS, problem
from culet.gateway.connections.connection import LINGER_SECONDS, GuardedConnection, Phase
from culet.gateway.connections.connection_guard import Guard
from culet.gateway.connections.lingering_transport import LingeringTransport
from culet.gateway.connections.paced_stream import PacedStream
from culet.gateway.limits.bucket import Bucket
from culet.gateway.limits.turns import EVENTS_PER_SECOND, TurnedConnection


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
    connection: GuardedConnection | None = None
    _waits = False
    """For its next turn."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - as uvicorn's
        super().__init__(*arguments, **options)
        self.conn = TurnedConnection(self.config.guard.turns)
        self._events = Bucket(EVENTS_PER_SECOND)

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as in uvicorn's
        """Let it in, or close it at once."""
        super().connection_made(LingeringTransport(transport, self.is_sending))
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

    def _lingering(self) -> LingeringTransport:
        assert isinstance(self.transport, LingeringTransport)  # noqa: S101 - by `connection_made`
        return self.transport

    @property
    def may_read(self) -> bool:
        """Whether the client may send, as far as this side lets it."""
        return not self.flow.read_paused

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


class GuardedStream(PacedStream):
    """A WebSocket, which the guard counts too."""

    config: GuardedConfig

    def connection_lost(self, exc: Exception | None) -> None:
        """It is gone."""
        self.config.guard.forget(self.transport)
        super().connection_lost(exc)
