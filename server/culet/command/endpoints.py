"""Options of the commands that run one of the two processes."""

from __future__ import annotations

from typing import Annotated

import typer

ControlEndpoint = Annotated[
    str, typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of control, ipc://... or tcp://...")
]
Frames = Annotated[str, typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of frames, ipc://... or tcp://...")]
Spare = Annotated[
    bool,
    typer.Option(
        envvar="CULET_SPARE",
        help="Keep another one ready to take over when it dies or hangs; a small process of their own watches both.",
    ),
]
