"""`culet engine`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from culet.blas import keep_blas_to_one_thread
from culet.command.endpoints import ControlEndpoint, Spare
from culet.command.help import ListedHelp
from culet.command.settings import options_of
from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line
from culet.endpoints import check_trusted
from culet.engine.capacity.limits import Limits
from culet.engine.process.strangers import engine_keys
from culet.logs import configure

app = single_command()


@app.command(cls=ListedHelp)
@options_of(Engine=Limits)
def engine(
    control: ControlEndpoint,
    frames: Annotated[
        list[str], typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of frames; repeatable, for several at once.")
    ],
    stand_by: Annotated[
        bool, typer.Option("--stand-by", help="Get ready, and begin with a line on the standard input.")
    ] = False,
    spare: Spare = False,
    *,
    given: dict[str, Any],
) -> None:
    """Run the render process alone: sessions, simulation and frames over ZeroMQ."""
    with errors_in_one_line():
        limits = Limits.read(given)
        configure(limits.log_level, limits.log_format)
        engine_keys(limits.keys)
        for option, endpoint in (("control", control), *(("frames", endpoint) for endpoint in frames)):
            check_trusted(endpoint, option, trusted=limits.trust_network or limits.keys is not None)
        if spare and not stand_by:  # one that stands by has the same environment
            from culet.service.serve import serve_engine

            serve_engine(control, frames, [*Limits.words(given)])
        else:
            keep_blas_to_one_thread()
            from culet.engine.process.serve import run

            run(control, frames, limits, stand_by=stand_by)
