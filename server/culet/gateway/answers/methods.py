"""Methods of HTTP beside those that routes have: HEAD wherever there is GET, OPTIONS everywhere, 405 for the others."""

from __future__ import annotations

import re
from collections.abc import Iterable

from fastapi.routing import APIRoute
from starlette.responses import Response
from starlette.routing import BaseRoute, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send

from culet.gateway.answers.problems import problem

_READING = frozenset({"GET"})
"""What a path that belongs to no route is for: a file of the page, or nothing."""


class Methods:
    """ASGI middleware for HTTP. A mount at `/` answers for whatever the routes do not, and would deny their methods."""

    def __init__(self, app: ASGIApp, routes: Iterable[BaseRoute]) -> None:
        self._app = app
        routes = list(routes)
        self._streams = [route.path_regex for route in routes if isinstance(route, WebSocketRoute)]
        self._routes: list[tuple[re.Pattern[str], frozenset[str]]] = [
            (route.path_regex, frozenset(route.methods or ())) for route in routes if isinstance(route, APIRoute)
        ]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket" and not any(pattern.match(scope["path"]) for pattern in self._streams):
            await problem(404, "not found", "there is no stream here")(scope, receive, send)
            return
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        methods = self._methods_of(scope["path"])
        allowed = methods | {"OPTIONS"} | ({"HEAD"} if "GET" in methods else set())
        method = scope["method"]
        if method == "OPTIONS":
            await Response(status_code=204, headers={"Allow": _listed(allowed)})(scope, receive, send)
        elif method not in allowed:
            detail = f"{scope['path'][:200]} takes {_listed(allowed)}, not {method[:20]}"
            await problem(405, "method not allowed", detail, headers={"Allow": _listed(allowed)})(scope, receive, send)
        else:  # the server leaves the body of an answer to HEAD out
            await self._app({**scope, "method": "GET"} if method == "HEAD" else scope, receive, send)

    def _methods_of(self, path: str) -> frozenset[str]:
        found = [methods for pattern, methods in self._routes if pattern.match(path)]
        return frozenset().union(*found) if found else _READING


def _listed(methods: Iterable[str]) -> str:
    return ", ".join(sorted(methods))
