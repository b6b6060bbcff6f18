"""The command lines of the processes of `culet serve`."""

from __future__ import annotations

import sys
from collections.abc import Sequence


def engine_command(control: str, *frames: str, options: Sequence[str] = ()) -> list[str]:
    """The command line of an engine that binds these endpoints."""
    published = [word for endpoint in frames for word in ("--frames", endpoint)]
    return [sys.executable, "-m", "culet", "engine", "--control", control, *published, *options]


def gateway_command(listening: int, settings: str) -> list[str]:
    """The command line of a gateway on a listening socket that it inherits, with its settings as JSON."""
    return [sys.executable, "-m", "culet.gateway.inherited", str(listening), settings]
