"""`culet serve`: a small process that holds the address and keeps a gateway and an engine running.

Neither of the two loses what matters when the other dies. The engine has the sessions, which a new gateway takes over;
the gateway has what a new engine needs to go on with them. The address belongs to this process: while a new gateway
starts, connections wait instead of being refused.
"""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from culet.endpoints import check_free
from culet.gateway.address import listening_socket, url_of
from culet.gateway.settings import settings_of
from culet.notify import Notice, notify
from culet.service.command_lines import engine_command, gateway_command
from culet.service.socket_folder import socket_folder
from culet.service.supervisor import Part, Supervisor

ENGINE_SILENCE_SECONDS = 22.0
"""An engine whose loop or render thread stands ends itself before (`culet.engine.process.watchdog`). This is for one
that cannot."""
GATEWAY_SILENCE_SECONDS = 60.0
"""The gateway's loop may be held up for up to 30 s, and goes on."""
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def serve(
    given: Mapping[str, Any],
    *,
    frames: str | None = None,
    engine_options: Sequence[str] = (),
    spare: bool = True,
) -> None:
    """Run engine and gateway until SIGINT or SIGTERM; print the URL once both are ready.

    `given` are the gateway's settings by field, `engine_options` words of the engine's command line. `frames`, such as
    `tcp://127.0.0.1:5556`, is where the engine publishes frames for native viewers too; without it they stay on this
    machine. With `spare` another one of each stands by.

    Raises InputError for a setting that cannot be used or an address that cannot be listened on, and
    EngineUnavailableError if one of the two dies again and again before it was ever ready.
    """
    if frames:
        check_free(frames, "frames")
    with socket_folder() as folder:
        control, own_frames = f"ipc://{folder}/control", f"ipc://{folder}/frames"
        settings = settings_of(given, control, own_frames)
        if settings.uploads_folder is None:
            settings = settings.model_copy(update={"uploads_folder": folder / "uploads"})
        command = engine_command(control, own_frames, *([frames] if frames else []), options=engine_options)
        engine = Part("engine", [*command, "--stand-by"], ENGINE_SILENCE_SECONDS, has_spare=spare)
        with listening_socket(settings.host, settings.port) as listening:
            number = listening.fileno()
            words = gateway_command(number, settings.model_dump_json())
            gateway = Part("gateway", words, GATEWAY_SILENCE_SECONDS, inherited=(number,), has_spare=spare)
            asyncio.run(_serve(folder, gateway, engine, url_of(listening, settings.host)))


async def _serve(folder: Path, gateway: Part, engine: Part, url: str) -> None:
    ready, stopping = asyncio.Event(), asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in STOP_SIGNALS:
        loop.add_signal_handler(number, stopping.set)
    supervisors = Supervisor(gateway, folder, ready.set), Supervisor(engine, folder)
    running = [asyncio.create_task(supervisor.run()) for supervisor in supervisors]
    announcement, stop = asyncio.create_task(_announce(ready, url)), asyncio.create_task(stopping.wait())
    try:
        await asyncio.wait([*running, stop], return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (announcement, stop):
            task.cancel()
        for supervisor in supervisors:  # the gateway first: it still has answers to give
            await supervisor.stop()
        results = await asyncio.gather(*running, return_exceptions=True)
        await asyncio.gather(announcement, stop, return_exceptions=True)
    for result in results:
        if isinstance(result, BaseException):
            raise result


async def _announce(ready: asyncio.Event, url: str) -> None:
    await ready.wait()
    print(f"culet is ready: {url}", flush=True)
    notify(Notice.READY)
