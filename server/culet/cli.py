"""The command line. What a command needs is imported when the command is used, so that `--version` answers at once."""

from __future__ import annotations

from typing import Annotated

import typer

from culet.command.single import CommandsOnDemand

EXIT_CODES = (
    "Exit codes: 0 done; 1 refused, or a check that failed: one line on stderr says what was expected and what came; "
    "2 wrong usage; 130 interrupted by Ctrl-C, but for servers, which end with 0."
)

app = typer.Typer(
    cls=CommandsOnDemand,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=EXIT_CODES,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from culet.version import __version__

        typer.echo(f"culet {__version__}")
        raise typer.Exit


@app.callback()
def culet(
    _version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_print_version, help="Print the version and exit.")
    ] = False,
) -> None:
    """Dispersive gemstones, traced exactly on the processor and streamed to thin clients."""
