"""`culet record`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line
from culet.command.watching import Endpoint, Folder, Patience, SessionId, WatchId, watched_by

app = single_command()


@app.command()
def record(
    endpoint: Endpoint,
    session: SessionId = None,
    watch: WatchId = None,
    seconds: Annotated[float, typer.Option(min=0, help="How long, counted from the first frame.")] = 10,
    out: Folder = Path("frames"),
    timeout: Patience = 10,
) -> None:
    """Take every frame of a session that comes in some seconds, straight from the engine, into a folder."""
    from culet_client.view import record as record_frames

    with errors_in_one_line(), watched_by(session, watch) as watched:
        count = record_frames(endpoint, watched, seconds, out, timeout_seconds=timeout)
        typer.echo(f"{out}: {count} frames")
