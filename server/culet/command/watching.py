"""What the commands that take frames of a session share."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated
from urllib.parse import parse_qs, urlsplit

import typer

Endpoint = Annotated[str, typer.Argument(help="Where the engine publishes frames, such as tcp://127.0.0.1:5556.")]
SessionOption = Annotated[
    str | None, typer.Option(help="The session's id, 32 hexadecimal digits; the page has it in its address.")
]
WatchId = Annotated[
    str | None, typer.Option(help="The session's watch id, in place of its id; `POST /api/sessions` gives it.")
]
Folder = Annotated[Path, typer.Option("-o", "--out", metavar="FOLDER", help="Folder for the frames; made if missing.")]
Patience = Annotated[float, typer.Option(min=0.1, help="Seconds to wait for a frame before giving up.")]


@contextmanager
def watched_by(session: str | None, watch: str | None) -> Iterator[str]:
    """The watch id of what the user named; that none of its frames came is said of the session that was named."""
    from culet_client.errors import ClientError, SilenceError
    from culet_protocol.watch import watch_id

    if (session is None) == (watch is None):
        raise ClientError("expected --session or --watch, got both or neither")
    if watch is not None:
        yield watch
        return
    if session is None or not re.fullmatch("[0-9a-f]{32}", session):
        raise ClientError(f"a session's id has 32 hexadecimal digits, got {session!r}")
    try:
        yield watch_id(session)
    except SilenceError as error:
        raise SilenceError(f"session {session}: {error}") from error


@contextmanager
def watched_at(address: str, session: str | None, watch: str | None) -> Iterator[str]:
    """As `watched_by`, of a session that may also be named by the address of its page."""
    query = parse_qs(urlsplit(address).query)
    if session is None and watch is None:
        session, watch = query.get("session", [None])[0], query.get("watch", [None])[0]
    with watched_by(session, watch) as watched:
        yield watched
