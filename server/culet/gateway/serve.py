"""`culet gateway`: the web process alone, for an engine that runs elsewhere."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any

from culet.endpoints import reachable
from culet.gateway.listener import Listener
from culet.gateway.settings import settings_of


def run_gateway(given: Mapping[str, Any], control: str, frames: str) -> None:
    """Run the gateway alone until SIGINT or SIGTERM, for an engine that somebody else starts.

    `given` are its settings, `control` and `frames` the engine's ZeroMQ endpoints. The gateway starts without the
    engine too, says so at /readyz, and finds it when it comes. Raises InputError for a setting that cannot be used or
    an address that cannot be listened on.
    """
    settings = settings_of(given, reachable(control), reachable(frames))
    with Listener(settings) as listener:
        asyncio.run(serve_and_announce(listener))


async def serve_and_announce(listener: Listener) -> None:
    """Serve until a stop signal; print the URL once the engine answers."""

    async def announce() -> None:
        await listener.gateway.link.ready.wait()
        print(f"culet is ready: {listener.url}", flush=True)

    announcement = asyncio.create_task(announce())
    try:
        await listener.run()
    finally:
        announcement.cancel()
