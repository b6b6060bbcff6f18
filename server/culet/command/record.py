"""`culet record`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line
from culet.command.watching import Patience, SessionOption, WatchId, watched_at

app = single_command()

Address = Annotated[
    str,
    typer.Argument(
        help="The session's page or server, such as 'http://127.0.0.1:8000/?session=...', or where an engine publishes "
        "frames, such as tcp://127.0.0.1:5556."
    ),
]
OutOption = Annotated[
    Path, typer.Option("-o", "--out", metavar="FOLDER|FILM.mp4", help="Folder for the frames, or a film's name.")
]
SizeOption = Annotated[
    str | None,
    typer.Option(
        metavar="WIDTHxHEIGHT",
        help="Pixels of the film, 1280x720 unless said; or of all pictures, which are PNGs then: else files are as "
        "they come, of many sizes while things move.",
    ),
]
ChromaOption = Annotated[
    str, typer.Option(help="Of a film: 444 keeps all colour; 420 halves its resolution, for players that need that.")
]
SIZES = 16, 8192


@app.command()
def record(
    endpoint: Address,
    session: SessionOption = None,
    watch: WatchId = None,
    seconds: Annotated[float, typer.Option(min=0, help="How long, counted from the first frame.")] = 10,
    out: OutOption = Path("frames"),
    size: SizeOption = None,
    chroma: ChromaOption = "444",
    timeout: Patience = 10,
) -> None:
    """Take every frame of a session that comes in some seconds, into a folder or, with PyAV, into a film."""
    from culet_client import view

    with errors_in_one_line(), watched_at(endpoint, session, watch) as watched:
        pixels = None if size is None else _pixels(size)
        if out.suffix.lower() == ".mp4":
            wanted = pixels or view.FILM_SIZE
            count = view.record_film(
                endpoint, watched, seconds, out, timeout_seconds=timeout, size=wanted, chroma=chroma
            )
        else:
            count = view.record(endpoint, watched, seconds, out, timeout_seconds=timeout, size=pixels)
        typer.echo(f"{out}: {count} frames")


def _pixels(size: str) -> tuple[int, int]:
    from culet_client.errors import ClientError

    found = re.fullmatch(r"(\d{1,5})x(\d{1,5})", size)
    if found is None or not all(SIZES[0] <= int(side) <= SIZES[1] for side in found.groups()):
        raise ClientError(f"size: expected such as 1280x720, each side {SIZES[0]} to {SIZES[1]} pixels, got {size!r}")
    return int(found[1]), int(found[2])
