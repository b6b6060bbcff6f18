"""What connections owe, and who makes room when there are too many, on real sockets."""

from __future__ import annotations

import asyncio
import contextlib
import resource
import socket
from collections.abc import AsyncIterator, Iterator

import httpx
import pytest
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from culet.errors import NotFoundError
from culet.gateway.connections import (
    connection_guard,
    guarded_http,
    lingering_transport,
)
from culet.gateway.connections.guarded_http import GuardedHttp
from culet.gateway.limits.open_files import RESERVED_FILES, connection_limit
from culet.gateway.sessions.sessions import Sessions
from culet.gateway.uploads.uploads import Uploads
from gateway.running import PATIENCE, Gateway, eventually, gateway_alone

HALF_AN_UPGRADE = b"GET /api/sessions/x/stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
HALF_A_HEAD = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX: "
HALF_A_BODY = b"POST /api/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99\r\n\r\n{"


class Peer:
    """A client that says what it likes."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    async def rest(self) -> bytes:
        """All that comes until the server closes."""
        async with asyncio.timeout(PATIENCE):
            try:
                return await self.reader.read()
            except ConnectionResetError:
                return b""

    @property
    def open(self) -> bool:
        return not self.reader.at_eof() and self.reader.exception() is None


@contextlib.asynccontextmanager
async def peers(gateway: Gateway, said: bytes, count: int = 1) -> AsyncIterator[list[Peer]]:
    """Connections on which that was said."""
    url = httpx.URL(gateway.url)
    made: list[Peer] = []
    try:
        for _ in range(count):
            made.append(Peer(*await asyncio.open_connection(url.host, url.port)))
            made[-1].writer.write(said)
        yield made
    finally:
        for peer in made:
            peer.writer.close()


@pytest.fixture
def quick_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Times that a test can wait for."""
    monkeypatch.setattr(connection_guard, "LOOK_SECONDS", 0.02)
    monkeypatch.setattr(connection_guard, "PROGRESS_SECONDS", 0.2)
    for module in (connection_guard, guarded_http, lingering_transport):
        monkeypatch.setattr(module, "LINGER_SECONDS", 0.2)
    monkeypatch.setattr(connection_guard, "UNREAD_SECONDS", 4.0)


@pytest.mark.usefixtures("quick_looks")
@pytest.mark.parametrize(
    ("said", "answer"),
    [
        (b"", b""),
        (HALF_A_HEAD, b"HTTP/1.1 408 "),
        (HALF_AN_UPGRADE, b"HTTP/1.1 408 "),
        (HALF_A_BODY, b"HTTP/1.1 408 "),
    ],
    ids=["nothing", "half a head", "half an upgrade", "half a body"],
)  # fmt: skip
async def test_what_is_not_sent_in_time_is_not_waited_for(said: bytes, answer: bytes) -> None:
    async with gateway_alone(head_seconds=0.2) as gateway, peers(gateway, said) as (peer,):
        assert (await peer.rest()).startswith(answer)


@pytest.mark.usefixtures("quick_looks")
async def test_a_slow_body_that_makes_progress_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection_guard, "PROGRESS_SECONDS", 2.0)  # longer than this process stands still
    body = b'{"preset": "no such"}'
    typed = HALF_A_BODY.replace(b"\r\n\r\n{", b"\r\nContent-Type: application/json\r\n\r\n")
    head = typed.replace(b"99", str(len(body)).encode()) + body[:1]
    async with gateway_alone(head_seconds=1, min_body_rate=1) as gateway, peers(gateway, head) as (peer,):
        for byte in body[1:]:
            await asyncio.sleep(0.15)
            peer.writer.write(bytes([byte]))
        async with asyncio.timeout(PATIENCE):
            assert b" 404 " in await peer.reader.readline()


@pytest.mark.usefixtures("quick_looks")
async def test_the_rest_of_a_body_that_was_refused_is_read_only_for_a_while() -> None:
    head = HALF_A_BODY.replace(b"99", b"99999999")
    async with gateway_alone() as gateway, peers(gateway, head) as (peer,):
        assert (await peer.rest()).startswith(b"HTTP/1.1 413 ")


@pytest.mark.parametrize("connection", ["close", "keep-alive"])
async def test_a_refusal_is_read_by_who_is_still_sending(connection: str) -> None:
    """What is sent to a closed socket is answered by a reset, which takes the refusal with it."""
    head = (
        f"POST /api/meshes HTTP/1.1\r\nHost: localhost\r\nConnection: {connection}\r\nContent-Length: 9000000\r\n\r\n"
    )
    async with gateway_alone() as gateway, peers(gateway, head.encode()) as (peer,):
        for _ in range(9):
            peer.writer.write(bytes(1_000_000))
            await peer.writer.drain()
        async with asyncio.timeout(PATIENCE):
            assert b" 422 " in await peer.reader.readline()


async def test_half_sent_requests_leave_room_for_the_next_visitor_from_the_same_address() -> None:
    async with (
        gateway_alone(max_connections_per_address=16) as gateway,
        peers(gateway, HALF_A_HEAD, 20) as heads,
        peers(gateway, HALF_A_BODY, 20) as bodies,
    ):
        async with httpx.AsyncClient(base_url=gateway.url, timeout=PATIENCE) as visitor:
            assert (await visitor.get("/healthz")).status_code == 200

        async def few() -> bool:
            return sum(peer.open for peer in heads + bodies) <= 16

        await eventually(few)
        assert not any(peer.open for peer in heads), "the oldest go first"


async def test_what_is_being_answered_is_not_ended_for_others(monkeypatch: pytest.MonkeyPatch) -> None:
    finished, begun = asyncio.Event(), 0

    async def work(*_: object) -> None:
        nonlocal begun
        begun += 1
        await finished.wait()
        raise NotFoundError("nothing")

    monkeypatch.setattr(Sessions, "get", lambda *_: None)
    monkeypatch.setattr(Sessions, "describe", work)
    request = b"GET /api/sessions/x HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    async with (
        gateway_alone(max_connections_per_address=8) as gateway,
        peers(gateway, HALF_A_HEAD, 3),
        peers(gateway, request, 8) as waiting,
    ):

        async def all_begun() -> bool:
            return begun == 8

        await eventually(all_begun)
        async with peers(gateway, request) as (late,):
            assert (await late.rest()).startswith(b"HTTP/1.1 503 ")
        finished.set()
        assert [(await peer.rest())[:13] for peer in waiting] == [b"HTTP/1.1 404 "] * 8


async def test_behind_a_trusted_proxy_the_address_that_it_forwards_is_the_one_that_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    finished, begun = asyncio.Event(), 0

    async def work(*_: object) -> None:
        nonlocal begun
        begun += 1
        await finished.wait()
        raise NotFoundError("nothing")

    async def all_begun() -> bool:
        return begun == 8

    def request(forwarded: str) -> bytes:
        fields = f"Host: localhost\r\nConnection: close\r\nX-Forwarded-For: 198.51.100.7, {forwarded}"
        return f"GET /api/sessions/x HTTP/1.1\r\n{fields}\r\n\r\n".encode()

    monkeypatch.setattr(Sessions, "get", lambda *_: None)
    monkeypatch.setattr(Sessions, "describe", work)
    async with (
        gateway_alone(max_connections_per_address=8, trusted_proxy=("127.0.0.1",)) as gateway,
        peers(gateway, HALF_A_HEAD, 20) as half,
        peers(gateway, request("203.0.113.1"), 8) as waiting,
    ):
        await eventually(all_begun)
        async with peers(gateway, request("203.0.113.1")) as (ninth,):
            assert (await ninth.rest()).startswith(b"HTTP/1.1 429 ")
        finished.set()
        async with peers(gateway, request("203.0.113.2")) as (other,):
            assert (await other.rest()).startswith(b"HTTP/1.1 404 ")
        assert [(await peer.rest())[:13] for peer in waiting] == [b"HTTP/1.1 404 "] * 8
        assert all(peer.open for peer in half), "the proxy itself is no client"


@contextlib.contextmanager
def open_files(soft: int) -> Iterator[None]:
    """With another limit."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_connections_never_take_the_last_open_file() -> None:
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    with open_files(512):
        assert connection_limit(1000) == min(1000, hard - RESERVED_FILES)
        assert resource.getrlimit(resource.RLIMIT_NOFILE)[0] >= connection_limit(1000) + RESERVED_FILES


async def test_an_answer_is_sent_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without TCP_NODELAY the body waits for the acknowledgement of the head."""
    made: list[int] = []
    real = GuardedHttp.connection_made

    def noted(self: GuardedHttp, transport: asyncio.Transport) -> None:
        made.append(transport.get_extra_info("socket").getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
        real(self, transport)

    monkeypatch.setattr(GuardedHttp, "connection_made", noted)
    async with gateway_alone():
        assert made
        assert all(made)


@pytest.mark.usefixtures("quick_looks")
async def test_who_reads_an_answer_slowly_gets_all_of_it_and_who_does_not_read_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture = bytes(range(256)) * 100_000  # more than the buffers of both sides hold

    async def rendered(*_: object, **__: object) -> tuple[dict[str, object], memoryview]:
        return {"samples": 1, "error": None, "met": None}, memoryview(picture)

    monkeypatch.setattr(Uploads, "request", rendered)
    request = b"GET /api/render.tga HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    async with gateway_alone(min_body_rate=1000) as gateway, peers(gateway, request, 2) as (slow, asleep):
        got = bytearray()
        async with asyncio.timeout(PATIENCE):
            while piece := await slow.reader.read(1 << 20):
                got += piece
                await asyncio.sleep(0.01)
        assert got.partition(b"\r\n\r\n")[2] == picture

        async def given_up() -> bool:
            return "culet_connections_ended_total 1.0\n" in (await gateway.http.get("/metrics")).text

        await eventually(given_up)
        assert len(await asleep.rest()) < len(picture)


OVERRIDDEN = {
    "H11Protocol": (
        H11Protocol, "_should_upgrade", "_unsupported_upgrade_warning", "handle_websocket_upgrade", "send_400_response",
        "on_response_complete",
    ),
    "WebSocketsSansIOProtocol": (
        WebSocketsSansIOProtocol, "receive", "resume_writing", "handle_ping", "handle_pong", "handle_cont",
    ),
    "Server": (uvicorn.Server, "startup", "capture_signals"),
}  # fmt: skip


@pytest.mark.parametrize("base", OVERRIDDEN)
def test_what_is_overridden_of_the_web_server_is_there(base: str) -> None:
    """One that was given another name would be overridden no more, and nothing would say so."""
    of, *names = OVERRIDDEN[base]
    assert [name for name in names if not callable(getattr(of, str(name), None))] == []
