"""`culet serve`: the gateway in this process, the engine as a supervised child."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from typing import Any

import zmq

from culet.endpoints import bind
from culet.errors import InputError
from culet.gateway.listener import Listener
from culet.gateway.settings import GatewaySettings
from culet.gateway.socket_folder import socket_folder
from culet.gateway.supervisor import Supervisor, engine_command


def serve(given: Mapping[str, Any], *, frames: str | None = None, engine_options: Sequence[str] = ()) -> None:
    """Run engine and gateway until SIGINT or SIGTERM; print the URL once both are ready.

    `given` are the gateway's settings by field, `engine_options` words of the engine's command line. `frames`, such as
    `tcp://127.0.0.1:5556`, is where the engine publishes frames for native viewers too; without it they stay on this
    machine. Raises InputError for a setting that cannot be used or an address that cannot be listened on, and
    EngineUnavailableError if the engine dies again and again before it was ever ready.
    """
    if frames:
        check_free(frames)
    with socket_folder() as folder:
        control, own_frames = f"ipc://{folder}/control", f"ipc://{folder}/frames"
        listener = Listener(settings_of(given, control, own_frames))
        command = engine_command(control, own_frames, *([frames] if frames else []), options=engine_options)
        asyncio.run(_serve(listener, Supervisor(command, listener.gateway.link.lose)))


def run_gateway(given: Mapping[str, Any], control: str, frames: str) -> None:
    """Run the gateway alone until SIGINT or SIGTERM, for an engine that somebody else starts.

    `given` are its settings, `control` and `frames` the engine's ZeroMQ endpoints. The gateway starts without the
    engine too, says so at /readyz, and finds it when it comes. Raises InputError for a setting that cannot be used or
    an address that cannot be listened on.
    """
    settings = settings_of(given, reachable(control), reachable(frames))
    asyncio.run(_serve(Listener(settings), None))


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


def settings_of(given: Mapping[str, Any], control: str, frames: str) -> GatewaySettings:
    """The gateway's settings; InputError for one that cannot be used, or a folder that holds no built page."""
    settings = GatewaySettings.read(given, control=control, frames=frames)
    page = settings.web / "index.html"
    if "web" in settings.model_fields_set and not page.is_file():
        raise InputError(f"web: expected the folder of a built web client; there is no {page}", "web")
    return settings


def check_free(endpoint: str) -> None:
    """InputError if frames cannot be published there."""
    with zmq.Context() as context, context.socket(zmq.XPUB) as socket:
        bind(socket, endpoint, "frames")


def reachable(endpoint: str) -> str:
    """The endpoint to connect to, for one that was bound on every interface."""
    return endpoint.replace("tcp://*:", "tcp://127.0.0.1:").replace("tcp://0.0.0.0:", "tcp://127.0.0.1:")
