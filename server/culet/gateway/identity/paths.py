"""Where the server is in the site of a proxy: a folder of it, whose name requests may come with or without."""

from __future__ import annotations

import posixpath
import re

from starlette.responses import RedirectResponse
from starlette.types import ASGIApp, Receive, Scope, Send

FOLDER = re.compile(r"(/[\w.~-]+)*", re.ASCII)
"""Of a site, as `/gems` or `/user/ann/proxy/8000`; empty for the whole of it."""


def reference(asked: str, path: str) -> str:
    """The path of something, relative to the path that was asked for (RFC 3986, section 4.2): right wherever a proxy
    has both, which the server need not know."""
    return posixpath.relpath(path, posixpath.dirname(asked))


class InFolder:
    """ASGI middleware that takes the folder's name off the paths of requests that come with it."""

    def __init__(self, app: ASGIApp, folder: str) -> None:
        self._app = app
        self._folder = folder

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and scope["path"] == self._folder:
            last = posixpath.basename(self._folder)
            query = scope["query_string"].decode("latin-1")
            answer = RedirectResponse(f"{last}/{'?' if query else ''}{query}", 308)  # or the page finds nothing
            await answer(scope, receive, send)
            return
        if scope["type"] in ("http", "websocket") and scope["path"].startswith(f"{self._folder}/"):
            length = len(self._folder)
            scope = {**scope, "path": scope["path"][length:]}
            if scope.get("raw_path"):
                scope["raw_path"] = scope["raw_path"][length:]  # a folder's name has no letter that is escaped
        await self._app(scope, receive, send)
