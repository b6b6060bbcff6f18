"""Headers that tell browsers to be careful with answers: with the page, the documentation and the interface alike."""

from __future__ import annotations

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from culet.gateway.settings import GatewaySettings

_PAGE = (
    "default-src 'none'; script-src 'self'; style-src 'self'; font-src data:; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'"
)
"""Its own scripts and styles, none within the document; pictures that it decodes, and icons within its styles."""
NOT_MODIFIED = 304
"""Its headers take the place of those that a browser has kept, and it does not say of what kind the answer was: a page
that is asked for again keeps its own policy."""
_DATA = "default-src 'none'; base-uri 'none'; form-action 'none'"


class SecurityHeaders:
    """ASGI middleware for HTTP; adds what an answer does not have by itself."""

    def __init__(self, app: ASGIApp, settings: GatewaySettings) -> None:
        self._app = app
        framing = " ".join(["frame-ancestors 'self'", *settings.frame_ancestor])
        self._page, self._data = f"{_PAGE}; {framing}", f"{_DATA}; {framing}"
        self._headers = {
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",  # the address of the page holds the session's id
            "Cross-Origin-Resource-Policy": "cross-origin" if settings.allow_embedding else "same-origin",
        }
        if not settings.frame_ancestor:
            self._headers["X-Frame-Options"] = "SAMEORIGIN"  # for browsers without frame-ancestors

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def careful(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                is_page = headers.get("content-type", "").startswith("text/html")
                if message["status"] != NOT_MODIFIED:
                    headers.setdefault("Content-Security-Policy", self._page if is_page else self._data)
                for name, value in self._headers.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, careful if scope["type"] == "http" else send)
