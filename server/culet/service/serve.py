"""`culet serve`: a small process that holds the address and keeps a gateway and an engine running.

Neither of the two loses what matters when the other dies. The engine has the sessions, which a new gateway takes over;
the gateway has what a new engine needs to go on with them. The address belongs to this process: while a new gateway
starts, connections wait instead of being refused.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from typing import Any

from culet.endpoints import check_free, reachable
from culet.gateway.engine.engine_door import check_one_engine
from culet.gateway.identity.address import entrance, listening_socket, local_url_of, url_of
from culet.gateway.settings import GatewaySettings, settings_of, with_token
from culet.gateway.token_file import token_kept
from culet.service.keeping import keep
from culet.service.parts import engine_part, gateway_part
from culet.service.socket_folder import socket_folder


def serve(
    given: Mapping[str, Any],
    *,
    frames: str | None = None,
    engine_options: Sequence[str] = (),
    spare: bool = True,
    open_page: bool = False,
) -> None:
    """Run engine and gateway until SIGINT or SIGTERM; print the URL once both are ready, and with `open_page` have a
    browser show the page.

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
        asked = settings_of(given, control, own_frames)
        settings = with_token(asked)
        if settings.uploads_folder is None:
            settings = settings.model_copy(update={"uploads_folder": folder / "uploads"})
        endpoints = [own_frames, *([frames] if frames else [])]
        engine = engine_part(control, *endpoints, options=engine_options, spare=spare)
        with listening_socket(settings.host, settings.port) as listening, token_kept(settings):
            gateway = gateway_part(listening, settings, spare=spare)
            url = entrance(url_of(listening, settings.host), _made(asked, settings))
            page = entrance(local_url_of(listening, settings.host), settings.token) if open_page else None
            asyncio.run(keep(folder, gateway, engine, ready_line=f"culet is ready: {url}", page=page))


def serve_engine(control: str, frames: Sequence[str], options: Sequence[str] = ()) -> None:
    """Run an engine, and another one that stands by, until SIGINT or SIGTERM.

    `control` and `frames` are the endpoints that it binds. EngineUnavailableError if it dies again and again before it
    was ever ready.
    """
    with socket_folder() as folder:
        asyncio.run(keep(folder, engine_part(control, *frames, options=options)))


def serve_gateway(given: Mapping[str, Any], control: str, frames: str) -> None:
    """Run a gateway, and another one that stands by, until SIGINT or SIGTERM, for an engine that somebody else starts.

    `given` are its settings, `control` and `frames` the engine's endpoints. InputError for a setting that cannot be
    used or an address that cannot be listened on.
    """
    check_one_engine({"control": control, "frames": frames})
    asked = settings_of(given, reachable(control), reachable(frames))
    settings = with_token(asked)
    with socket_folder() as folder, listening_socket(settings.host, settings.port) as listening, token_kept(settings):
        if settings.uploads_folder is None:
            settings = settings.model_copy(update={"uploads_folder": folder / "uploads"})
        gateway = gateway_part(listening, settings, alone=True)
        url = entrance(url_of(listening, settings.host), _made(asked, settings))
        asyncio.run(keep(folder, gateway, ready_line=f"culet is ready: {url}"))


def _made(asked: GatewaySettings, settings: GatewaySettings) -> str | None:
    """The token, if it was made: one that was given is known, and need be told to nobody who reads what is printed."""
    return settings.token if asked.token is None else None
