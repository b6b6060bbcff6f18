"""What may come in at all: requests for this server, from pages that may make them, with bodies up to a limit."""

from __future__ import annotations

import re

from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from culet.errors import BusyError, TooLargeError
from culet.gateway.admission.upload_paths import UPLOADS
from culet.gateway.answers.problems import RETRY_AFTER_SECONDS, problem, problem_of
from culet.gateway.identity.client_address import client_of
from culet.gateway.identity.origins import Hosts, is_address, may_enter
from culet.gateway.limits.holdings import Holdings
from culet.gateway.settings import GatewaySettings

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_PICTURES = re.compile(r"/api/(render|turntable|sessions/[^/]+/frame)\.\w+")
"""GETs that take the engine's time. Any page can have its visitors' browsers ask for them, as an <img>."""


class BodyBytes:
    """Bytes of request bodies that are under way, in all and of each client."""

    def __init__(self, limit: int, limit_of_client: int) -> None:
        self._held = Holdings()
        self._limit = limit
        self._limit_of_client = limit_of_client

    @property
    def bytes(self) -> int:
        """Of all clients."""
        return self._held.total

    def room_for(self, client: str, size: int) -> bool:
        """Whether so many bytes more would be within the limits."""
        return self.bytes + size <= self._limit and self._held.of(client) + size <= self._limit_of_client

    def take(self, client: str, size: int) -> None:
        """So many bytes came."""
        self._held.take(client, size)

    def give_back(self, client: str, size: int) -> None:
        """A request with so many bytes is done with."""
        self._held.give_back(client, size)


class Admission:
    """ASGI middleware for HTTP and WebSocket.

    421 for another host's requests, 403 for other pages' that change something or cost much, 413 for bodies over the
    limit, 429 where a client has too much under way, 400 for a body of two lengths.
    """

    def __init__(self, app: ASGIApp, *, settings: GatewaySettings, largest_form: int) -> None:
        """`largest_form` is the limit for paths that take files, in place of the settings' `max_body_bytes`."""
        self._app = app
        self._settings = settings
        self._largest_form = largest_form
        own = () if is_address(settings.host) else (settings.host,)
        self._hosts = Hosts([*settings.allow_host, *own])
        self._bodies = BodyBytes(settings.max_bodies_bytes, settings.max_client_bodies_bytes)
        self._open = Holdings()
        """Requests and streams under way, of each client."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] == "http" and not self._settings.allow_embedding and _PICTURES.fullmatch(scope["path"]):
            send = _varying_by_site(send)
        refusal = self._refusal(scope)
        if refusal is not None:
            await refusal(scope, receive, send)
            return
        client = client_of(scope)
        with self._open.held(client):
            await self._counted(client, scope, receive, send)

    def _refusal(self, scope: Scope) -> Response | None:
        """Why not, by what the head says."""
        headers = Headers(scope=scope)
        if not self._hosts.allow(headers.get("host")):
            detail = (
                f"this server does not go by the name {headers['host'][:80]!r}; --allow-host makes it one of its names"
            )
            return problem(421, "misdirected request", detail)
        client = client_of(scope)
        if self._open.of(client) >= self._settings.max_connections_per_address:
            detail = f"{client} has {self._open.of(client)} requests and streams under way, which is the limit"
            return problem_of(BusyError(detail))
        if scope["type"] == "websocket":
            return None  # told by a close code who may open streams
        method, path = scope["method"], scope["path"]
        if method not in SAFE_METHODS and not may_enter(scope, self._settings.allow_origin):
            detail = f"pages of {headers['origin'][:80]} may not change anything here; --allow-origin lets them"
            return problem(403, "forbidden", detail)
        if _PICTURES.fullmatch(path) and self._is_embedding(headers):
            detail = "pages of other sites may not show pictures of this server; --allow-embedding lets them"
            return problem(403, "forbidden", detail)
        if "transfer-encoding" in headers and "content-length" in headers:
            return problem(400, "bad request", "expected Content-Length or Transfer-Encoding, got both")
        declared = headers.get("content-length", "")
        if declared.isdecimal():
            limit = self._limit(path)
            if int(declared) > limit:
                field = "file" if UPLOADS.fullmatch(path) else None
                return problem_of(TooLargeError(f"{_too_large(limit)}, got {declared}", field))
            if not self._bodies.room_for(client, int(declared)):
                return problem_of(BusyError(self._no_room()))
        return None

    def _is_embedding(self, headers: Headers) -> bool:
        """Whether a page of another site asks, by what browsers say since 2020 (2023 for Safari)."""
        if self._settings.allow_embedding or headers.get("origin") in self._settings.allow_origin:
            return False
        return headers.get("sec-fetch-site") == "cross-site"

    async def _counted(self, client: str, scope: Scope, receive: Receive, send: Send) -> None:
        """The request, the bytes of its body counted as they come."""
        limit, came = self._limit(scope["path"]), 0

        async def counted() -> Message:
            nonlocal came
            message = await receive()
            size = len(message.get("body", b""))
            if came + size > limit:
                detail = f"{_too_large(limit)}, got more"
                if UPLOADS.fullmatch(scope["path"]):
                    raise TooLargeError(detail, "file")
                raise HTTPException(TooLargeError.status, detail)  # FastAPI makes 400 of others, reading JSON
            if not self._bodies.room_for(client, size):
                raise HTTPException(BusyError.status, self._no_room(), {"Retry-After": RETRY_AFTER_SECONDS})
            self._bodies.take(client, size)
            came += size
            return message

        try:
            await self._app(scope, counted if scope["type"] == "http" else receive, send)
        finally:
            self._bodies.give_back(client, came)

    def _limit(self, path: str) -> int:
        return self._largest_form if UPLOADS.fullmatch(path) else int(self._settings.max_body_bytes)

    def _no_room(self) -> str:
        return f"{self._bodies.bytes} bytes of bodies are under way; try again later"


def _too_large(limit: int) -> str:
    return f"expected a body of at most {limit} bytes"


def _varying_by_site(send: Send) -> Send:
    """With a word to caches that many share (RFC 9110, 12.5.5): what one page is shown another one is refused. What
    depends on the origin, CORSMiddleware says."""

    async def varying(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).add_vary_header("Sec-Fetch-Site")
        await send(message)

    return varying
