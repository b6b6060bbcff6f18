"""The gateway's process under `culet serve`, which holds the address for all gateways that come and go.

python -m culet.gateway.inherited SOCKET SETTINGS, the number of a listening socket and `GatewaySettings` as JSON
"""

from __future__ import annotations

import asyncio
import socket
import sys

from culet.gateway.listener import Listener
from culet.gateway.settings import GatewaySettings
from culet.logs import configure


def main() -> None:
    """Wait for a line on the standard input, with everything loaded, then serve until SIGTERM."""
    if not sys.stdin.readline():  # whoever was to say it has gone
        return
    listening = socket.socket(fileno=int(sys.argv[1]))
    settings = GatewaySettings.model_validate_json(sys.argv[2])
    configure(settings.log_level, settings.log_format)
    with Listener(settings, listening) as listener:
        asyncio.run(listener.run())


if __name__ == "__main__":
    main()
