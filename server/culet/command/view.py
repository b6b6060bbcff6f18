"""`culet view`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line
from culet.command.watching import Endpoint, Folder, Patience, SessionOption, WatchId, watched_by

app = single_command()


@app.command()
def view(
    endpoint: Endpoint,
    session: SessionOption = None,
    watch: WatchId = None,
    frames: Annotated[int, typer.Option(min=1, help="How many frames to take.")] = 10,
    out: Folder = Path("frames"),
    timeout: Patience = 10,
) -> None:
    """Take the latest frames of a session, straight from the engine, into a folder."""
    from culet_client.view import view as view_frames

    with errors_in_one_line(), watched_by(session, watch) as watched:
        count = view_frames(endpoint, watched, frames, out, timeout_seconds=timeout)
        typer.echo(f"{out}: {count} frames")
