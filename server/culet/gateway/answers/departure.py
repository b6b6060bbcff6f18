"""Answers that are not waited for any longer, as the client leaves or the server stops: what is done for them only is
given up."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import TypeVar

from starlette.requests import Request

from culet.errors import CuletError, EngineUnavailableError

T = TypeVar("T")

LAST_SECONDS = 1.5
"""For what is nearly done when the server is told to stop; less than the web server's own patience."""


class ClientLeftError(CuletError):
    """Nobody is there to get the answer; only the metrics see this one."""

    status = 499  # as nginx has it
    title = "client left"


async def while_waited_for(request: Request, work: Coroutine[None, None, T]) -> T:
    """The result of the work, which is cancelled when the client leaves, or soon after the server is told to stop
    (EngineUnavailableError). The request's body must have been read."""
    working, leaving = asyncio.create_task(work), asyncio.create_task(_left(request))
    closing = asyncio.create_task(_closed(request.app.state.gateway.stopping))
    tasks = working, leaving, closing
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        if working.done():
            return working.result()
        if closing.done():
            raise EngineUnavailableError("the server is being stopped; ask again when it is back")
        raise ClientLeftError("the client left before its answer was there")
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _closed(stopping: asyncio.Event) -> None:
    await stopping.wait()
    await asyncio.sleep(LAST_SECONDS)


async def _left(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass
