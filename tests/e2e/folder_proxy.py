"""A proxy that shows a server in a folder of its own site, and passes requests on without its name."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from urllib.parse import urlsplit

from shared.patience import PATIENCE

LARGEST_HEAD = 65536


class FolderProxy:
    """Listens on a free port of loopback for as long as the `with` lasts; a connection serves one request."""

    def __init__(self, server: str, folder: str) -> None:
        """Before the server at that address. `folder` begins and does not end with a slash."""
        self._port = urlsplit(server).port
        self._folder = folder
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever)
        self.url = ""

    def __enter__(self) -> FolderProxy:
        self._thread.start()
        listening = asyncio.start_server(self._serve, "127.0.0.1", 0, limit=LARGEST_HEAD)
        self._server = asyncio.run_coroutine_threadsafe(listening, self._loop).result(PATIENCE)
        self.url = f"http://127.0.0.1:{self._server.sockets[0].getsockname()[1]}{self._folder}"
        return self

    def __exit__(self, *_: object) -> None:
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result(PATIENCE)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _end(self) -> None:
        self._server.close()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """One request and all that follows it."""
        with contextlib.suppress(OSError, asyncio.IncompleteReadError, asyncio.CancelledError):
            head = await reader.readuntil(b"\r\n\r\n")
            method, path, rest = head.split(b" ", 2)
            folder = self._folder.encode()
            if not path.startswith(folder):
                writer.write(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")
            else:
                upgrade = b"\r\nupgrade:" in head.lower()
                rest = rest if upgrade else rest.replace(b"\r\n", b"\r\nConnection: close\r\n", 1)
                passed = b" ".join([method, path[len(folder) :], rest])
                await self._pass_on(passed, reader, writer)
        writer.close()
        with contextlib.suppress(OSError, asyncio.CancelledError):
            await writer.wait_closed()

    async def _pass_on(self, head: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        from_server, to_server = await asyncio.open_connection("127.0.0.1", self._port)
        to_server.write(head)
        ways = [asyncio.create_task(_pour(reader, to_server)), asyncio.create_task(_pour(from_server, writer))]
        try:
            await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for way in ways:
                way.cancel()
            await asyncio.gather(*ways, return_exceptions=True)
            to_server.close()
            with contextlib.suppress(OSError):
                await to_server.wait_closed()


async def _pour(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await reader.read(65536):
        writer.write(data)
        await writer.drain()
