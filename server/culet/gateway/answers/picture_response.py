"""An answer with a picture, sent piece by piece: the largest are hundreds of megabytes, and are never copied whole."""

from __future__ import annotations

from typing import Any

from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from culet.gateway.answers.quality import QUALITY_HEADERS

PIECE_BYTES = 256 * 1024
"""What waits for a slow reader, besides the picture itself."""


class PictureResponse(Response):
    """As `Response`, for a body of any length."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        del receive
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        if scope["method"] != "HEAD":
            body = memoryview(self.body)
            for at in range(0, len(body), PIECE_BYTES):
                piece = bytes(body[at : at + PIECE_BYTES])
                await send({"type": "http.response.body", "body": piece, "more_body": True})
        await send({"type": "http.response.body"})


BINARY = {"type": "string", "format": "binary"}
"""What OpenAPI calls bytes."""


def picture_answers(
    *media_types: str, headers: tuple[str, ...] = (), rendered: bool = True
) -> dict[int | str, dict[str, Any]]:
    """What OpenAPI should say about the answer of a route: a picture of one of these kinds, with these headers, and
    those that say how good a rendered picture is."""
    return {
        200: {
            "description": "The picture.",
            "content": {kind: {"schema": BINARY} for kind in media_types},
            "headers": {name: {"schema": {"type": "string"}} for name in headers}
            | (QUALITY_HEADERS if rendered else {}),
        }
    }
