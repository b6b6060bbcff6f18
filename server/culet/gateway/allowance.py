"""How many requests a client may make: 429 for those that are too many."""

from __future__ import annotations

import math
import time

from starlette.types import ASGIApp, Receive, Scope, Send

from culet.errors import BusyError
from culet.gateway.bucket import ClientBuckets
from culet.gateway.client_address import client_of
from culet.gateway.problems import problem

REQUEST_COST = 10
"""Messages of a stream that cost as much: 30 us each, against some 0.3 ms for the way through the application."""
SESSION_COST = 40
"""For a new session, whose stone and sky are made in the engine."""
LIMITED = "/api/"
"""Paths that begin so. The page, its files, health and metrics are cheap, and whoever is over the limit needs them."""


class Allowance:
    """ASGI middleware for HTTP. What is refused further in was asked for, and costs the same."""

    def __init__(self, app: ASGIApp, clients: ClientBuckets) -> None:
        self._app = app
        self._clients = clients

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or not scope["path"].startswith(LIMITED):
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
        opens = scope["method"] == "POST" and scope["path"] == "/api/sessions"
        bucket.spend(SESSION_COST if opens else REQUEST_COST, now)
        await self._app(scope, receive, send)
