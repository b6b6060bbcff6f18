"""The gateway's web server: a listening socket, and uvicorn on it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import signal
import socket
from collections.abc import Iterator
from types import TracebackType
from typing import Self

import uvicorn

from culet.gateway.app import create_app
from culet.gateway.connections.connection_guard import Guard
from culet.gateway.connections.guarded_http import GuardedConfig
from culet.gateway.identity.address import BACKLOG, listening_socket, url_of
from culet.gateway.identity.client_address import read_proxies, trusted_hosts
from culet.gateway.settings import GatewaySettings
from culet.gateway.state import Gateway
from culet.notify import ServiceNotice, notify
from culet.settings import MEBIBYTE

log = logging.getLogger(__name__)

GRACEFUL_SHUTDOWN_SECONDS = 3
"""For answers under way at SIGTERM; containers are killed after 10 s."""
MAX_WEBSOCKET_MESSAGE = MEBIBYTE
"""uvicorn closes the socket above this; below it, and above the control limit, the viewer gets a notice."""
PONG_SECONDS = 40.0
"""For the answer to a ping, which on a slow line comes behind two frames: 600 kB each at 30 kB/s."""
ACCEPTED_AT_ONCE = 64
"""Connections that are accepted before those that make room for them are closed."""
ALIVE_SECONDS = 1.0


class Listener:
    """Holds the address from its creation on, so that a taken port is known before anything is started."""

    def __init__(self, settings: GatewaySettings, listening: socket.socket | None = None) -> None:
        """Listen at the settings' address, or on a socket that listens already. InputError if that cannot be."""
        proxies = read_proxies(settings.trusted_proxy)
        self._socket = listening or listening_socket(settings.host, settings.port)
        self.url = url_of(self._socket, settings.host)
        app = create_app(settings)
        self.gateway: Gateway = app.state.gateway
        guard = Guard(settings, proxies)
        metrics = self.gateway.metrics
        metrics.watch("culet_connections", "Connections open.", guard.__len__)
        metrics.watch("culet_connections_ended", "Ended for owing, or for others.", lambda: guard.ended, counts=True)
        self._stopping: asyncio.Task[None] | None = None
        self._told = False
        """SIGTERM has come."""
        self._server = _Server(
            GuardedConfig(
                app,
                guard,
                lifespan="on",
                log_config=None,
                log_level="error",
                access_log=False,  # the gateway has its own
                ws_max_size=MAX_WEBSOCKET_MESSAGE,
                ws_ping_timeout=PONG_SECONDS,
                ws_per_message_deflate=False,  # frames are compressed already
                forwarded_allow_ips=trusted_hosts(proxies),
                server_header=False,
                backlog=ACCEPTED_AT_ONCE,
                timeout_graceful_shutdown=GRACEFUL_SHUTDOWN_SECONDS,
            )
        )

    async def run(self) -> None:
        """Serve until SIGINT or `stop`; or, once SIGTERM has come or a drain was begun, until nobody is there any more
        or the settings' time is up. A second SIGTERM ends it at once."""
        loop = asyncio.get_running_loop()
        loop.add_signal_handler(signal.SIGTERM, self._terminate)
        loop.add_signal_handler(signal.SIGINT, self.stop)
        companions = [
            asyncio.create_task(self._drain()),
            asyncio.create_task(self._say_that_it_lives()),
            asyncio.create_task(self._server.config.guard.run()),
        ]
        try:
            await self._server.serve(sockets=[self._socket])
        finally:
            for task in companions:
                task.cancel()
            for number in (signal.SIGTERM, signal.SIGINT):
                loop.remove_signal_handler(number)

    def stop(self) -> None:
        """Close streams, finish answers, leave `run`."""
        if self._stopping is None:
            self._stopping = asyncio.create_task(self._stop())

    def _terminate(self) -> None:
        if self._told:
            self.stop()
        self._told = True
        self.gateway.sessions.drain.begin(self.gateway.settings.drain_seconds)

    async def _drain(self) -> None:
        sessions = self.gateway.sessions
        await sessions.drain.begun.wait()
        if sessions.drain.left > 0:
            log.info("draining: no new sessions; ending in %.0f s, or when nobody is left", sessions.drain.left)
            sessions.warn()

        async def busy() -> bool:
            # A request or a stream each: stills and turntables of no session are waited for too.
            return bool(self._server.server_state.tasks) or await sessions.in_use()

        await sessions.drain.over(busy)
        self.stop()

    async def _stop(self) -> None:
        self.gateway.stopping.set()
        await self.gateway.sessions.farewell()
        self._server.should_exit = True

    async def _say_that_it_lives(self) -> None:
        """To the supervisor, if there is one: ready once the engine answers, and alive from then on."""
        await self.gateway.sessions.taken_over.wait()
        notify(ServiceNotice.READY)
        while True:
            notify(ServiceNotice.ALIVE)
            await asyncio.sleep(ALIVE_SECONDS)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._socket.close()


class _Server(uvicorn.Server):
    """uvicorn raises a caught signal again when it has stopped, which would end the process before its engine."""

    config: GuardedConfig

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen; asyncio takes one number for what it accepts at once and for what may wait to be accepted."""
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(BACKLOG)

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield
