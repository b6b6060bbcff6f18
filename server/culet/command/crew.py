"""Who does the work of a command: this process, workers on this machine, or those of a scheduler."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.errors import InputError

if TYPE_CHECKING:
    from culet.batch.crew import Crew

Workers = Annotated[
    int | None,
    typer.Option(
        "--workers", min=1, max=1024, metavar="N", help="Processes that share the work, each on one processor, by Dask."
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler", metavar="tls://HOST:PORT", help="Dask's, whose workers share the work, on whatever machines."
    ),
]
TlsCa = Annotated[
    Path | None, typer.Option("--tls-ca", metavar="FILE", help="Certificate that the scheduler's rests on, in PEM.")
]
TlsCert = Annotated[
    Path | None, typer.Option("--tls-cert", metavar="FILE", help="Certificate to show to the scheduler, in PEM.")
]
TlsKey = Annotated[Path | None, typer.Option("--tls-key", metavar="FILE", help="Key of that certificate, in PEM.")]

EXTRA = "culet[batch]"


@contextmanager
def crew_of(
    workers: int | None,
    scheduler: str | None,
    ca: Path | None,
    cert: Path | None,
    key: Path | None,
    *,
    afterwards: str | None = None,
) -> Iterator[Crew]:
    """Who was asked for; InputError for two at once, and without the extra that workers need.

    `afterwards` says what becomes of the work if the scheduler is lost; without it the same command goes on.
    """
    from culet.batch.crew import IN_PROCESS

    if workers is not None and scheduler is not None:
        raise InputError("workers: expected --workers or --scheduler, got both", "workers")
    if scheduler is None and (ca or cert or key):
        raise InputError("tls-ca: certificates are for a --scheduler, got none", "scheduler")
    if workers is None and scheduler is None:
        yield IN_PROCESS
        return
    if find_spec("distributed") is None or find_spec("cryptography") is None:
        option = "workers" if scheduler is None else "scheduler"
        raise InputError(f"{option}: workers need Dask: pip install '{EXTRA}'; this process alone needs none", option)
    from culet.batch.cluster import RESUMES, Certificates, local, remote

    said = RESUMES if afterwards is None else afterwards
    if scheduler is not None:
        with remote(scheduler, Certificates(ca, cert, key), _tell, said) as crew:
            yield crew
    elif workers is not None:
        with local(workers, _tell, said) as crew:
            yield crew


def _tell(text: str) -> None:
    """Above the progress bar, if there is one."""
    typer.echo(f"culet: {text}", err=True)
