"""`culet keys`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line

app = single_command()


@app.command()
def keys(
    folder: Annotated[Path, typer.Argument(help="Where the folders are made, one for each machine.")],
    clients: Annotated[
        list[str] | None,
        typer.Option("--for", metavar="NAME", help="Who may connect to the engine; repeatable. Default: gateway."),
    ] = None,
) -> None:
    """Make keys for an engine and those who connect to it from other machines: what travels by tcp:// is encrypted
    then, and nobody else is let in.

    FOLDER/engine goes to the engine, FOLDER/NAME to whoever has that name; each is named there by --keys, or by
    CULET_KEYS. Asked again with another name, a client is added; the engine knows of it when it is started anew.
    """
    from culet.errors import InputError
    from culet_protocol.keys import KeysError, make_keys

    with errors_in_one_line():
        try:
            made = make_keys(folder, clients or ["gateway"])
        except (KeysError, OSError) as error:
            raise InputError(str(error)) from error
        for each in made:
            typer.echo(each)
