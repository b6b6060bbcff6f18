"""`culet serve`: the gateway in this process, the engine as a supervised child."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from pathlib import Path

import zmq

from culet.endpoints import bind
from culet.gateway.listener import Listener
from culet.gateway.settings import BUILT_CLIENT, GatewaySettings
from culet.gateway.socket_folder import socket_folder
from culet.gateway.supervisor import Supervisor, engine_command


def serve(
    host: str = "127.0.0.1",
    port: int = 8000,
    *,
    frames: str | None = None,
    web: Path = BUILT_CLIENT,
    allowed_origins: Sequence[str] = (),
) -> None:
    """Run engine and gateway until SIGINT or SIGTERM; print the URL once both are ready.

    `port` 0 takes a free one. `frames`, such as `tcp://127.0.0.1:5556`, is where the engine publishes frames for
    native viewers too; without it they stay on this machine. Raises InputError if an address cannot be listened on,
    and EngineUnavailableError if the engine dies again and again before it was ever ready.
    """
    if frames:
        check_free(frames)
    with socket_folder() as folder:
        control, own_frames = f"ipc://{folder}/control", f"ipc://{folder}/frames"
        settings = GatewaySettings(control=control, frames=own_frames, web=web, allowed_origins=tuple(allowed_origins))
        listener = Listener(settings, host, port)
        command = engine_command(control, own_frames, *([frames] if frames else []))
        asyncio.run(_serve(listener, Supervisor(command, listener.gateway.link.lose)))


def run_gateway(
    control: str,
    frames: str,
    host: str = "127.0.0.1",
    port: int = 8000,
    *,
    web: Path = BUILT_CLIENT,
    allowed_origins: Sequence[str] = (),
) -> None:
    """Run the gateway alone until SIGINT or SIGTERM, for an engine that somebody else starts.

    `control` and `frames` are the engine's ZeroMQ endpoints. The gateway starts without the engine too, says so at
    /readyz, and finds it when it comes. Raises InputError if the address cannot be listened on.
    """
    settings = GatewaySettings(
        control=reachable(control), frames=reachable(frames), web=web, allowed_origins=tuple(allowed_origins)
    )
    asyncio.run(_serve(Listener(settings, host, port), None))


async def _serve(listener: Listener, supervisor: Supervisor | None) -> None:
    with listener:
        serving = asyncio.create_task(listener.run())
        tasks: set[asyncio.Task[None]] = {serving}
        if supervisor:
            tasks.add(asyncio.create_task(supervisor.run()))
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            listener.stop()
            await serving
            if supervisor:
                await supervisor.stop()
        for task in done:
            task.result()


def check_free(endpoint: str) -> None:
    """InputError if frames cannot be published there."""
    with zmq.Context() as context, context.socket(zmq.XPUB) as socket:
        bind(socket, endpoint, "frames")


def reachable(endpoint: str) -> str:
    """The endpoint to connect to, for one that was bound on every interface."""
    return endpoint.replace("tcp://*:", "tcp://127.0.0.1:").replace("tcp://0.0.0.0:", "tcp://127.0.0.1:")
