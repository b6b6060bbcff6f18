"""A gateway whose loop can be held up: it sleeps on its loop for the seconds of each line that it reads.

python tests/gateway/held_gateway.py CONTROL FRAMES
"""

from __future__ import annotations

import asyncio
import sys
import time

from culet.gateway.listener import Listener
from culet.gateway.serve import serve_and_announce
from culet.gateway.settings import GatewaySettings


async def main() -> None:
    """Serve until told to stop."""
    with Listener(GatewaySettings(control=sys.argv[1], frames=sys.argv[2], port=0)) as listener:

        def hold() -> None:
            seconds = float(sys.stdin.readline() or 0)
            time.sleep(seconds)
            print(f"held up for {seconds:g} s", flush=True)

        asyncio.get_running_loop().add_reader(sys.stdin, hold)
        await serve_and_announce(listener)


if __name__ == "__main__":
    asyncio.run(main())
