"""`culet gateway`."""

from __future__ import annotations

from typing import Any

from culet.command.endpoints import ControlEndpoint, Frames, Spare
from culet.command.help import ListedHelp
from culet.command.settings import options_of
from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line
from culet.gateway.settings import GatewaySettings
from culet.logs import configure
from culet.settings import Settings

app = single_command()


@app.command(cls=ListedHelp)
@options_of(Gateway=GatewaySettings)
def gateway(control: ControlEndpoint, frames: Frames, spare: Spare = False, *, given: dict[str, Any]) -> None:
    """Run the web process alone, for an engine that runs elsewhere."""
    with errors_in_one_line():
        settings = Settings.read(given)
        configure(settings.log_level, settings.log_format)
        if spare:
            from culet.service.serve import serve_gateway

            serve_gateway(given, control, frames)
        else:
            from culet.gateway.serve import run_gateway

            run_gateway(given, control, frames)
