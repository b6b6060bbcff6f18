"""Parts that are kept running until this process is told to stop."""

from __future__ import annotations

import asyncio
import signal
import threading
from pathlib import Path

from culet.notify import ServiceNotice, notify
from culet.service.browser import show
from culet.service.supervisor import ServerPart, Supervisor


async def keep(folder: Path, *parts: ServerPart, ready_line: str = "", page: str | None = None) -> None:
    """Keep all of them running until SIGINT or SIGTERM, or until one of them ends as it was asked to; the first one is
    stopped first. `folder` is for their sockets, and for what leads a browser to the page.

    At SIGTERM the first one may take its time (`Part.drain_seconds`), in which the others go on; SIGINT, and a second
    SIGTERM, end all at once.

    Once the first one is ready, whoever supervises this process is told, a line, if there is one, is printed, and the
    user's browser is shown the page, if there is one.
    EngineUnavailableError if one dies again and again before it was ever ready.
    """
    ready, stopping, at_once = asyncio.Event(), asyncio.Event(), asyncio.Event()

    def terminate() -> None:
        (at_once if stopping.is_set() else stopping).set()

    def interrupt() -> None:
        at_once.set()
        stopping.set()

    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGTERM, terminate)
    loop.add_signal_handler(signal.SIGINT, interrupt)
    first, *others = parts
    supervisors = [Supervisor(first, folder, ready.set), *(Supervisor(part, folder) for part in others)]
    running = [asyncio.create_task(supervisor.run()) for supervisor in supervisors]
    announcement = asyncio.create_task(_announce(ready, ready_line, page, folder))
    stop = asyncio.create_task(stopping.wait())
    try:
        await asyncio.wait([*running, stop], return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (announcement, stop):
            task.cancel()
        notify(ServiceNotice.STOPPING)
        for supervisor in supervisors:
            await supervisor.stop(at_once)
        results = await asyncio.gather(*running, return_exceptions=True)
        await asyncio.gather(announcement, stop, return_exceptions=True)
    for result in results:
        if isinstance(result, BaseException):
            raise result


async def _announce(ready: asyncio.Event, line: str, page: str | None, folder: Path) -> None:
    await ready.wait()
    if line:
        print(line, flush=True)
    notify(ServiceNotice.READY)
    if page is not None:  # in a thread of its own that nobody waits for: a browser may run in the terminal
        threading.Thread(target=show, args=(page, folder), daemon=True).start()
