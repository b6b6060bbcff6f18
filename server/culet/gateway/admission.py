"""What may come in at all: bodies up to a limit, and, from browsers, only pages of the allowed origins."""

from __future__ import annotations

from collections.abc import Collection
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from culet.gateway.problems import problem

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


def may_enter(headers: Headers, allow_origin: Collection[str]) -> bool:
    """Whether a request comes from no page at all, from a page of this host, or from an allowed origin.

    Browsers open a WebSocket to any host, and send forms there, without asking: CORS covers neither.
    """
    origin = headers.get("origin")
    if origin is None:
        return True
    return origin in allow_origin or urlsplit(origin).netloc == headers.get("host")


class Admission:
    """ASGI middleware for HTTP: 403 for other pages' requests that change something, 413 for bodies over the limit.

    Paths in `own_limit` count their bytes themselves.
    """

    def __init__(
        self, app: ASGIApp, *, allow_origin: Collection[str], max_body_bytes: int, own_limit: Collection[str]
    ) -> None:
        self._app = app
        self._allow_origin = allow_origin
        self._max_body_bytes = max_body_bytes
        self._own_limit = own_limit

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        if scope["method"] not in SAFE_METHODS and not may_enter(headers, self._allow_origin):
            detail = f"pages of {headers['origin']} may not change anything here"
            await problem(403, "forbidden", detail)(scope, receive, send)
            return
        if scope["path"] in self._own_limit:
            await self._app(scope, receive, send)
            return
        limit, came = self._max_body_bytes, 0
        too_large = f"expected a body of at most {limit} bytes"

        async def counted() -> Message:
            nonlocal came
            message = await receive()
            came += len(message.get("body", b""))
            if came > limit:
                raise HTTPException(413, f"{too_large}, got more")
            return message

        declared = headers.get("content-length", "")
        if declared.isdecimal() and int(declared) > limit:
            await problem(413, "too large", f"{too_large}, got {declared}")(scope, receive, send)
            return
        await self._app(scope, counted, send)
