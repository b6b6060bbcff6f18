"""The access log: one line for each answer, and two for each stream; counted by status too."""

from __future__ import annotations

import asyncio
import logging
import re
import time

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from culet.errors import EngineUnavailableError
from culet.gateway.answers.problems import problem_of
from culet.gateway.identity.client_address import client_of
from culet.gateway.operation.metrics import Metrics
from culet.logs import FIELDS

log = logging.getLogger("culet.access")

_SECRET = re.compile(r"\b([0-9a-f]{6})[0-9a-f]{26}\b")
"""A session's id: whoever reads it may change the session. Its beginning tells sessions apart."""
_PROBES = frozenset({"/healthz", "/readyz", "/metrics"})
"""Asked again and again by machines; logged when they fail, or at level debug."""


class AccessLog:
    """ASGI middleware for HTTP and WebSocket."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        match scope["type"]:
            case "http":
                await self._answer(scope, receive, send)
            case "websocket":
                await self._stream(scope, receive, send)
            case _:
                await self._app(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        began, status, size = time.monotonic(), 0, 0

        async def noted(message: Message) -> None:
            nonlocal status, size
            if message["type"] == "http.response.start":
                status = message["status"]
            size += len(message.get("body", b""))
            await send(message)

        try:
            await self._app(scope, receive, noted)
        except asyncio.CancelledError:  # the server stops, and has waited for this one long enough
            if status:
                raise
            await problem_of(EngineUnavailableError("the server is stopping"))(scope, receive, noted)
        finally:
            seconds = time.monotonic() - began
            self._metrics.answered(status or 500, seconds)
            level = logging.DEBUG if scope["path"] in _PROBES and status < 400 else logging.INFO
            fields = {**_asked(scope), "status": status or 500, "bytes": size, "seconds": round(seconds, 4)}
            log.log(level, "%(client)s %(method)s %(target)s %(status)d, %(bytes)d bytes, %(seconds)g s", fields,
                    extra={FIELDS: fields})  # fmt: skip

    async def _stream(self, scope: Scope, receive: Receive, send: Send) -> None:
        began, code, reason = time.monotonic(), 0, ""
        asked = _asked(scope) | {"method": "WS"}

        async def noted(message: Message) -> None:
            nonlocal code, reason
            match message["type"]:
                case "websocket.accept":
                    log.info("%(client)s %(method)s %(target)s opened", asked, extra={FIELDS: asked})
                case "websocket.close":
                    code, reason = message.get("code", 1000), message.get("reason") or ""
                case "websocket.http.response.start":
                    code, reason = message["status"], "refused"
            await send(message)

        async def heard() -> Message:
            nonlocal code, reason
            message = await receive()
            if message["type"] == "websocket.disconnect" and not code:
                code, reason = message.get("code", 1006), "by the viewer"
            return message

        try:
            await self._app(scope, heard, noted)
        finally:
            seconds = round(time.monotonic() - began, 3)
            fields = {**asked, "code": code or 1006, "reason": reason, "seconds": seconds}
            self._metrics.stream_closed(code or 1006)
            log.info("%(client)s %(method)s %(target)s closed after %(seconds)g s: %(code)d %(reason)s", fields,
                     extra={FIELDS: fields})  # fmt: skip


def _asked(scope: Scope) -> dict[str, str]:
    """Who asked for what; the target as it came, in which no character is special."""
    query = scope["query_string"].decode("latin-1")
    target = scope["raw_path"].decode("latin-1") + (f"?{query}" if query else "")
    printable = target if target.isprintable() else repr(target)
    return {
        "client": client_of(scope),
        "method": scope.get("method", "GET")[:20],
        "target": _SECRET.sub(r"\1...", printable[:500]),
    }
