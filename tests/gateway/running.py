"""Starts what the gateway's tests talk to, and talks to it as a browser would."""

from __future__ import annotations

import asyncio
import contextlib
import io
import json
import select
import subprocess
import tempfile
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from typing import Any, NamedTuple

import httpx
from PIL import Image
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Origin, Subprotocol

from culet.gateway.listener import Listener
from culet.gateway.settings import GatewaySettings
from culet.gateway.state import Gateway as Parts
from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Flags, Frame
from culet_protocol.messages import Message, Resize
from culet_protocol.parts import with_parts
from shared import patience

PATIENCE = patience.PATIENCE
SIZE = Resize(width=64, height=36)

TETRAHEDRON = b"v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def png(width: int, height: int, colour: tuple[int, int, int]) -> bytes:
    """A picture of one colour."""
    buffer = io.BytesIO()
    Image.new("RGB", (width, height), colour).save(buffer, "PNG")
    return buffer.getvalue()


class Endpoints(NamedTuple):
    """Of an engine."""

    control: str
    frames: str


class Gateway(NamedTuple):
    """A running web server."""

    url: str
    http: httpx.AsyncClient
    parts: Parts

    async def session(self, scene: dict[str, Any] | None = None) -> str:
        """A new session's id."""
        answer = await self.http.post("/api/sessions", json={"scene": scene or {}})
        assert answer.status_code == 201, answer.text
        session: str = answer.json()["id"]
        return session

    async def engine_status(self) -> dict[str, float]:
        """The engine's numbers, from /metrics."""
        text = (await self.http.get("/metrics")).text
        lines = [line.split() for line in text.splitlines() if line.startswith("culet_engine_")]
        return {name.removeprefix("culet_engine_"): float(value) for name, value in lines}

    @contextlib.asynccontextmanager
    async def viewer(
        self,
        session: str,
        *,
        size: Message | None = SIZE,
        path: str | None = None,
        **options: Any,  # noqa: ANN401
    ) -> AsyncIterator[Viewer]:
        """A viewer that has said its size; `path` is that of the stream, where the session does not say it."""
        options = {"subprotocols": [Subprotocol(SUBPROTOCOL)], "max_size": None, "compression": None} | options
        url = self.url.replace("http", "ws", 1) + (path or f"api/sessions/{session}/stream")
        async with connect(url, **options) as websocket:
            viewer = Viewer(websocket)
            if size is not None:
                await viewer.say(size)
            yield viewer


class Viewer:
    """The other end of a stream: reads always, keeps all notices and frames, acknowledges if it is told to."""

    def __init__(self, websocket: ClientConnection, *, acknowledges: bool = True) -> None:
        self.websocket = websocket
        self.acknowledges = acknowledges
        self.frames: list[Frame] = []
        self.notices: list[dict[str, Any]] = []
        """Changes as the states that they make."""
        self.changes: list[dict[str, Any]] = []
        """As they came."""
        self.sent = 0
        """Control events and acknowledgements."""
        self._state: dict[str, Any] = {}

    async def say(self, message: Message) -> None:
        """Send a control event."""
        self.sent += 1
        async with asyncio.timeout(PATIENCE):
            await self.websocket.send(message.model_dump_json())

    async def receive(self) -> None:
        """One message."""
        message = await self.websocket.recv()
        if isinstance(message, str):
            self.notices.append(self._whole(json.loads(message)))
            return
        frame = Frame.unpack(message)
        self.frames.append(frame)
        if self.acknowledges:
            self.sent += 1
            with contextlib.suppress(ConnectionClosed):  # in a browser too, what came before a close is still received
                await self.websocket.send(json.dumps({"type": "ack", "sequence": frame.sequence}))

    def _whole(self, notice: dict[str, Any]) -> dict[str, Any]:
        """A change as the state that it makes of the one before; any other notice as it came."""
        if notice["type"] == "change":
            assert notice["since"] == self._state["revision"]
            self.changes.append(notice)
            scene = with_parts(self._state["scene"], notice["parts"])
            notice = {name: value for name, value in notice.items() if name not in ("since", "parts")}
            notice |= {"type": "state", "scene": scene}
        if notice["type"] == "state":
            self._state = notice
        return notice

    async def until(self, condition: Callable[[], bool]) -> None:
        """Receive until the condition holds."""
        async with asyncio.timeout(PATIENCE):
            while not condition():
                await self.receive()

    async def notice(self, kind: str) -> dict[str, Any]:
        """The first notice of that type that is not taken yet, taken; receives until there is one."""
        await self.until(lambda: any(notice["type"] == kind for notice in self.notices))
        found = next(notice for notice in self.notices if notice["type"] == kind)
        self.notices.remove(found)
        return found

    async def frame(self) -> Frame:
        """The next frame."""
        before = len(self.frames)
        await self.until(lambda: len(self.frames) > before)
        return self.frames[-1]

    async def final(self) -> Frame:
        """The last frame of a picture at rest."""
        await self.until(lambda: bool(self.frames and Flags.FINAL in self.frames[-1].flags))
        return self.frames[-1]


def announced(server: subprocess.Popen[str]) -> str:
    """The URL that a server which was just started prints once it is ready."""
    assert server.stdout
    readable, _, _ = select.select([server.stdout], [], [], PATIENCE)
    line = server.stdout.readline() if readable else ""
    assert line.startswith("culet is ready: http://127.0.0.1:"), line
    return line.split()[-1]


@contextlib.contextmanager
def engine_process(command: Callable[[str, str], Sequence[str]]) -> Iterator[Endpoints]:
    """The endpoints of an engine that the command for these two starts."""
    with tempfile.TemporaryDirectory(prefix="culet-test-") as folder:  # pytest's own folders can be too long for ipc
        endpoints = Endpoints(f"ipc://{folder}/control", f"ipc://{folder}/frames")
        process = subprocess.Popen(command(*endpoints))
        try:
            yield endpoints
        finally:
            process.terminate()
            try:
                assert process.wait(PATIENCE) == 0
            finally:
                process.kill()  # one that outlived the tests would keep whoever reads their output waiting
                process.wait()


@contextlib.asynccontextmanager
async def gateway_before(engine: Endpoints, **limits: Any) -> AsyncIterator[Gateway]:  # noqa: ANN401
    """A web server with these settings, in this process, once it hears the engine; without the sessions that other
    tests have left there."""
    settings = GatewaySettings(control=engine.control, frames=engine.frames, port=0, **limits)
    with Listener(settings) as listener:
        serving = asyncio.create_task(listener.run())
        try:
            async with httpx.AsyncClient(base_url=listener.url, timeout=PATIENCE) as http:
                sessions = listener.gateway.sessions
                async with asyncio.timeout(PATIENCE):
                    await sessions.taken_over.wait()
                for session in list(sessions):
                    await sessions.close(session)
                yield Gateway(listener.url, http, listener.gateway)
        finally:
            listener.stop()
            async with asyncio.timeout(PATIENCE):
                await serving


@contextlib.asynccontextmanager
async def gateway_alone(**limits: Any) -> AsyncIterator[Gateway]:  # noqa: ANN401
    """A web server with these settings that has no engine, and does not wait for one."""
    limits = {"engine_start_seconds": 0} | limits
    settings = GatewaySettings(control="ipc:///nowhere/control", frames="ipc:///nowhere/frames", port=0, **limits)
    with Listener(settings) as listener:
        serving = asyncio.create_task(listener.run())
        try:
            async with httpx.AsyncClient(base_url=listener.url, timeout=PATIENCE) as http:

                async def answers() -> bool:
                    try:
                        return (await http.get("/healthz")).is_success
                    except httpx.TransportError:
                        return False

                await eventually(answers)
                yield Gateway(listener.url, http, listener.gateway)
        finally:
            listener.stop()
            async with asyncio.timeout(PATIENCE):
                await serving


async def eventually(condition: Callable[[], Any]) -> None:
    """Until an awaitable condition is true."""
    async with asyncio.timeout(PATIENCE):
        while not await condition():  # noqa: ASYNC110 - the condition is another process's
            await asyncio.sleep(0.01)


FOREIGN = Origin("http://elsewhere.example")
