"""The command line. What a command needs is imported by the command, so that `--help` answers at once."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from culet.errors import CuletError

app = typer.Typer(
    help="Dispersive gemstones, traced exactly on the processor and streamed to thin clients.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

Control = Annotated[str, typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of control, ipc://... or tcp://...")]
Frames = Annotated[str, typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of frames, ipc://... or tcp://...")]
Host = Annotated[str, typer.Option(help="Address to listen on; 0.0.0.0 for every one.")]
Port = Annotated[int, typer.Option(min=0, max=65535, help="Port to listen on; 0 for a free one.")]
Web = Annotated[
    Path | None, typer.Option(help="Folder of the built web client, instead of the one that belongs to it.")
]
Origins = Annotated[
    list[str] | None,
    typer.Option("--allow-origin", metavar="ORIGIN", help="A further page that may use this server; repeatable."),
]


@contextlib.contextmanager
def errors_in_one_line() -> Iterator[None]:
    """A CuletError is the user's to read: one line on stderr and exit code 1, no traceback."""
    try:
        yield
    except CuletError as error:
        typer.echo(f"culet: {error}", err=True)
        raise typer.Exit(1) from None


@app.command()
def serve(
    host: Host = "127.0.0.1",
    port: Port = 8000,
    frames: Annotated[
        str | None,
        typer.Option(
            metavar="ENDPOINT", help="Publish frames for native viewers here too, such as tcp://127.0.0.1:5556."
        ),
    ] = None,
    web: Web = None,
    allow_origin: Origins = None,
) -> None:
    """Serve the web page: gateway and engine, restarted when it dies. Stop with Ctrl-C."""
    from culet.gateway.serve import serve as run
    from culet.gateway.settings import BUILT_CLIENT

    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    with errors_in_one_line():
        run(host, port, frames=frames, web=web or BUILT_CLIENT, allowed_origins=allow_origin or ())


@app.command()
def gateway(
    control: Control,
    frames: Frames,
    host: Host = "127.0.0.1",
    port: Port = 8000,
    web: Web = None,
    allow_origin: Origins = None,
) -> None:
    """Run the web process alone, for an engine that runs elsewhere."""
    from culet.gateway.serve import run_gateway
    from culet.gateway.settings import BUILT_CLIENT

    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    with errors_in_one_line():
        run_gateway(control, frames, host, port, web=web or BUILT_CLIENT, allowed_origins=allow_origin or ())


@app.command()
def engine(control: Control, frames: Frames) -> None:
    """Run the render process alone: sessions, simulation and frames over ZeroMQ."""
    from culet.engine.serve import run

    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    with errors_in_one_line():
        run(control, frames)
