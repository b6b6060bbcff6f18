"""The parts of a server: how each is started, and when each counts as hung."""

from __future__ import annotations

import math
import socket
from collections.abc import Sequence

from culet.gateway.settings import GatewaySettings
from culet.service.command_lines import engine_command, gateway_command
from culet.service.supervisor import START_SECONDS, ServerPart
from culet.settings import variable

ENGINE_SILENCE_SECONDS = 22.0
"""An engine whose loop or render thread stands ends itself before (`culet.engine.process.watchdog`). This is for one
that cannot."""
GATEWAY_SILENCE_SECONDS = 35.0
"""The gateway's loop may be held up for up to 30 s, and goes on."""


def engine_part(control: str, *frames: str, options: Sequence[str] = (), spare: bool = True) -> ServerPart:
    """An engine that binds these endpoints."""
    command = engine_command(control, *frames, options=options)
    return ServerPart("engine", [*command, "--stand-by"], ENGINE_SILENCE_SECONDS, has_spare=spare)


def gateway_part(
    listening: socket.socket, settings: GatewaySettings, *, spare: bool = True, alone: bool = False
) -> ServerPart:
    """A gateway on a listening socket, which outlives it. One that is `alone` is ready when somebody else has started
    the engine, whenever that is."""
    number = listening.fileno()
    return ServerPart(
        "gateway",
        gateway_command(number, settings.model_dump_json(exclude={"token"})),
        GATEWAY_SILENCE_SECONDS,
        environment={variable("token"): settings.token or ""},  # this process's own may not count
        inherited=(number,),
        has_spare=spare,
        start_seconds=math.inf if alone else START_SECONDS,
        drain_seconds=settings.drain_seconds,
    )
