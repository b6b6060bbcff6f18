"""`culet gateway`: the web process alone, for an engine that runs elsewhere."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any

from culet.endpoints import reachable
from culet.gateway.engine.engine_door import check_one_engine
from culet.gateway.identity.address import entrance
from culet.gateway.listener import Listener
from culet.gateway.settings import settings_of, with_token
from culet.gateway.token_file import token_kept


def run_gateway(given: Mapping[str, Any], control: str, frames: str) -> None:
    """Run the gateway alone until SIGINT or SIGTERM, for an engine that somebody else starts.

    `given` are its settings, `control` and `frames` the engine's ZeroMQ endpoints. The gateway starts without the
    engine too, says so at /readyz, and finds it when it comes. Raises InputError for a setting that cannot be used or
    an address that cannot be listened on.
    """
    check_one_engine({"control": control, "frames": frames})
    asked = settings_of(given, reachable(control), reachable(frames))
    settings = with_token(asked)
    with Listener(settings) as listener, token_kept(settings):
        asyncio.run(serve_and_announce(listener, settings.token if asked.token is None else None))


async def serve_and_announce(listener: Listener, token: str | None = None) -> None:
    """Serve until a stop signal; print the URL, with a token that was made, once the engine answers."""

    async def announce() -> None:
        await listener.gateway.link.ready.wait()
        print(f"culet is ready: {entrance(listener.url, token)}", flush=True)

    announcement = asyncio.create_task(announce())
    try:
        await listener.run()
    finally:
        announcement.cancel()
