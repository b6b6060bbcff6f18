"""How commands speak: errors as one line, progress as a bar."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import typer

from culet.errors import CuletError
from culet_client.errors import ClientError

if TYPE_CHECKING:
    from rich.console import Console

REPORT_COLUMNS = 150


@contextlib.contextmanager
def errors_in_one_line() -> Iterator[None]:
    """Errors on purpose are the user's to read: one line on stderr and exit code 1, no traceback."""
    try:
        yield
    except (CuletError, ClientError) as error:
        typer.echo(f"culet: {error}", err=True)
        raise typer.Exit(1) from None


@contextlib.contextmanager
def progress_bar(label: str) -> Iterator[Callable[[float], None]]:
    """A bar on a terminal, gone when done; call it with the part done, 0 to 1."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(label, total=1.0)
        yield lambda done: progress.update(task, completed=done)


def report_console() -> Console:
    """For tables, which a file or a pipe gets in REPORT_COLUMNS."""
    from rich.console import Console

    console = Console()
    return console if console.is_terminal else Console(width=REPORT_COLUMNS)
