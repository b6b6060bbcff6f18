"""`culet serve`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from culet.command.help import ListedHelp
from culet.command.settings import options_of
from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line
from culet.endpoints import check_trusted
from culet.engine.capacity.limits import Limits
from culet.engine.process.strangers import engine_keys
from culet.gateway.settings import GatewaySettings
from culet.logs import configure

app = single_command()


@app.command(cls=ListedHelp)
@options_of(Gateway=GatewaySettings, Engine=Limits)
def serve(
    frames: Annotated[
        str | None,
        typer.Option(
            metavar="ENDPOINT", help="Publish frames for native viewers here too, such as tcp://127.0.0.1:5556."
        ),
    ] = None,
    spare: Annotated[
        bool,
        typer.Option(
            envvar="CULET_SPARE",
            help="Keep another engine and gateway ready to take over when one dies; they take some 260 MiB of memory.",
        ),
    ] = True,
    open_page: Annotated[
        bool,
        typer.Option("--open", envvar="CULET_OPEN", help="Show the page in a browser once it is there."),
    ] = False,
    *,
    given: dict[str, Any],
) -> None:
    """Serve the web page: gateway and engine, each restarted when it dies. Stop with Ctrl-C."""
    from culet.service.serve import serve as run

    with errors_in_one_line():
        limits = Limits.read(given)  # before the child would complain of them
        configure(limits.log_level, limits.log_format)
        engine_keys(limits.keys)
        if frames is not None:
            check_trusted(frames, "frames", trusted=limits.trust_network or limits.keys is not None)
        run(given, frames=frames, engine_options=[*Limits.words(given)], spare=spare, open_page=open_page)
