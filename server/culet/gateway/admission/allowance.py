"""How many requests a client may make: 429 for those that are too many."""

from __future__ import annotations

import math
import time

from starlette.types import ASGIApp, Receive, Scope, Send

from culet.errors import BusyError
from culet.gateway.answers.problems import problem
from culet.gateway.identity.client_address import client_of
from culet.gateway.limits.bucket import ClientBuckets

FREE = frozenset({"/healthz", "/readyz"})
"""Whoever looks after the server asks these, and is never refused."""
FILE_COST = 1
"""For the page and its files, in messages of a stream, which take some 30 us each."""
REQUEST_COST = 5
"""For a request that the application or the engine answers."""
SESSION_COST = 20
"""For a new session, whose stone and sky are made in the engine."""
STREAM_COST = 10
"""For a new stream, which is told the scene and given a frame."""


def cost_of(method: str, path: str) -> int:
    """Of an HTTP request."""
    if (path == "/api/sessions" and method == "POST") or (path.startswith("/api/sessions/") and method == "PUT"):
        return SESSION_COST
    return REQUEST_COST if path.startswith("/api/") or path in ("/metrics", "/docs", "/openapi.json") else FILE_COST


class RequestAllowance:
    """ASGI middleware for HTTP. What is refused further in was asked for, and costs the same."""

    def __init__(self, app: ASGIApp, clients: ClientBuckets) -> None:
        self._app = app
        self._clients = clients

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["path"] in FREE:
            await self._app(scope, receive, send)
            return
        now, client = time.monotonic(), client_of(scope)
        bucket = self._clients.of(client, now)
        wait = bucket.overdrawn_for(now)
        if wait > 0:
            headers = {"Retry-After": str(math.ceil(wait))}
            detail = f"{client} asks for more than its share of this server; try again in {headers['Retry-After']} s"
            await problem(BusyError.status, BusyError.title, detail, headers=headers)(scope, receive, send)
            return
        bucket.spend(cost_of(scope["method"], scope["path"]), now)
        await self._app(scope, receive, send)
