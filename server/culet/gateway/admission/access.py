"""Who may do what: the one gate that every request and every stream passes.

The server's token lets do everything. Without it a session's own two links let do what they are for: whoever knows the
session's id watches and steers it, whoever knows its watch id watches it. So what names a session needs no token here;
what the name lets do, `Sessions` knows. A server without a token is its own machine's, and lets do everything.
"""

from __future__ import annotations

import re
from enum import Flag, auto

from starlette.datastructures import Headers
from starlette.requests import cookie_parser
from starlette.types import ASGIApp, Receive, Scope, Send

from culet.gateway.admission.upload_paths import UPLOADS
from culet.gateway.answers.problems import problem
from culet.gateway.identity.origins import own_origin
from culet.gateway.identity.server_token import Token
from culet.gateway.settings import GatewaySettings

LOGIN_PATH = "/api/login"
CHALLENGE = 'Bearer realm="culet"'
DETAIL = (
    "expected this server's token, as `Authorization: Bearer ...`; a browser gets it by the address that culet printed "
    "when it was started"
)


class Right(Flag):
    """What somebody may do."""

    WATCH = auto()
    """See sessions, and have pictures of them."""
    STEER = auto()
    """Make and change sessions, and have pictures of any scene."""
    UPLOAD = auto()
    """Bring meshes and skies."""
    ADMINISTER = auto()
    """Know how the server is and what is open on it, and have it stopped."""


NOTHING, ALL = Right(0), Right.WATCH | Right.STEER | Right.UPLOAD | Right.ADMINISTER

_NAMED = re.compile(r"/api/(sessions/[^/]+(/.*)?|stream)")
"""Where a session is named, by an id that is a secret."""
_LISTS = re.compile(r"/api/(presets|materials|cuts|skies|integrators)(/.*)?")
"""What there is to choose from."""
_ADMINISTRATION = frozenset({"/api/drain"})
_HEALTH = frozenset({"/healthz", "/readyz"})


def needed(method: str, path: str, settings: GatewaySettings) -> Right:
    """What a request needs besides what names a session: the page, its files and lists need nothing."""
    if path in _HEALTH:
        return NOTHING if settings.open_health else Right.ADMINISTER
    if path == "/metrics":
        return NOTHING if settings.open_metrics else Right.ADMINISTER
    if path in _ADMINISTRATION or (path == "/api/sessions" and method in ("GET", "HEAD")):
        return Right.ADMINISTER
    if UPLOADS.fullmatch(path) and method == "POST":
        return Right.UPLOAD
    if method == "PUT" and path.startswith("/api/sessions/"):
        return Right.STEER  # a session is made: knowing its name is not enough
    if not path.startswith("/api/") or _NAMED.fullmatch(path):
        return NOTHING
    return NOTHING if method in ("GET", "HEAD") and _LISTS.fullmatch(path) else Right.STEER


class Access:
    """ASGI middleware for HTTP and WebSocket. 401 for what needs the token, without it.

    What the caller may do by the token is in the scope's state, as `rights`.
    """

    def __init__(self, app: ASGIApp, settings: GatewaySettings) -> None:
        self._app = app
        self._settings = settings
        self._token = None if settings.token is None else Token(settings.token)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        rights = self.rights(scope)
        scope.setdefault("state", {})["rights"] = rights
        method = scope.get("method", "GET")
        if method != "OPTIONS" and needed(method, scope["path"], self._settings) & ~rights:
            await problem(401, "token needed", DETAIL, headers={"WWW-Authenticate": CHALLENGE})(scope, receive, send)
            return
        await self._app(scope, receive, send)

    def rights(self, scope: Scope) -> Right:
        """By the token, which a header or a cookie has."""
        if self._token is None:
            return ALL
        headers = Headers(scope=scope)
        kind, _, given = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer" and self._token.is_it(given.strip()):
            return ALL
        kept = cookie_parser(headers.get("cookie", "")).get(cookie_name(scope))  # whatever else a browser keeps
        return ALL if kept is not None and self._token.is_cookie(kept) else NOTHING


def cookie_name(scope: Scope) -> str:
    """Of the cookie that a browser keeps for this server: cookies know hosts, and not their ports."""
    origin = own_origin(scope)
    return f"culet-{0 if origin is None else origin.port}"
