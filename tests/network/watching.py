"""A viewer at the far end of a shaped link, and the server at the near one."""

from __future__ import annotations

import asyncio
import contextlib
import json
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from http.client import HTTPConnection
from pathlib import Path

from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Ack, Message, Ping, Resize
from network import namespaces
from network.shaped_link import SERVER, Link
from shared.patience import PATIENCE

PORT = 8077
STRETCH = 20
"""Frames that are looked at together."""
PING_SECONDS = 0.25


@dataclass(frozen=True)
class Arrival:
    """A frame at the far end."""

    at: float
    """s, the clock of `time.time`."""
    latency: float
    """s, since it was encoded."""
    bytes: int
    width: int
    height: int
    moving: bool
    """One sample of each pixel, as while something moves."""


@dataclass
class Seen:
    """Of a stretch of time."""

    arrivals: list[Arrival]
    round_trips: list[float]
    """s, of pings."""
    seconds: float

    @property
    def rate(self) -> float:
        """Frames a second."""
        return len(self.arrivals) / self.seconds

    def latency(self, part: float = 0.95) -> float:
        """s, that so large a part of the frames keeps."""
        return percentile([arrival.latency for arrival in self.arrivals], part)

    def __str__(self) -> str:
        sizes = [arrival.bytes for arrival in self.arrivals]
        return (
            f"{self.rate:.1f} frames/s, latency {self.latency(0.5):.3f} / {self.latency():.3f} s, "
            f"largest {max(arrival.latency for arrival in self.arrivals):.3f} s, "
            f"{sum(sizes) / len(sizes) / 1e3:.1f} kB, at most {max(sizes) / 1e3:.1f} kB, "
            f"{max(arrival.width for arrival in self.arrivals)} pixels wide, "
            f"round trip at most {max(self.round_trips, default=float('nan')):.2f} s"
        )


def percentile(values: Sequence[float], part: float) -> float:
    """The value that so large a part of them does not exceed."""
    return sorted(values)[min(len(values) - 1, int(part * len(values)))]


@dataclass
class Watcher:
    """Reads and acknowledges at once, and pings, in a thread of its own in the viewer's namespace."""

    link: Link
    session: str
    size: Resize
    near: bool = False
    """It watches at the server's end, without a link between."""
    arrivals: list[Arrival] = field(default_factory=list)
    round_trips: list[tuple[float, float]] = field(default_factory=list)
    """When a ping was answered, and how long that took."""
    closed: str | None = None
    """Why the stream ended, if the test did not end it."""
    _loop: asyncio.AbstractEventLoop | None = None
    _say: asyncio.Queue[Message | None] = field(default_factory=asyncio.Queue)
    _asked_at: float | None = None
    """When the ping was sent that is not answered yet."""

    @contextmanager
    def watching(self) -> Iterator[Watcher]:
        """While the block runs."""
        thread = threading.Thread(target=self._run)
        thread.start()
        try:
            yield self
        finally:
            self.say(None)
            thread.join()

    def say(self, message: Message | None) -> None:
        """Send a message; None: leave."""
        deadline = time.monotonic() + PATIENCE
        while self._loop is None and time.monotonic() < deadline and self.closed is None:
            time.sleep(0.01)
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # it has ended
                self._loop.call_soon_threadsafe(self._say.put_nowait, message)

    def seen(self, seconds: float) -> Seen:
        """What comes in the next so many seconds."""
        begun = time.time()
        time.sleep(seconds)  # the stretch that is measured
        pings = [took for at, took in self.round_trips if at >= begun]
        if self._asked_at is not None:
            pings.append(time.time() - self._asked_at)
        return Seen([arrival for arrival in self.arrivals if arrival.at >= begun], pings, seconds)

    def frames_until(self, condition: Callable[[Sequence[Arrival]], bool]) -> None:
        """Wait until a condition holds of the last frames that have come since, STRETCH of them."""
        begun, deadline = len(self.arrivals), time.monotonic() + PATIENCE
        while True:
            frames = self.arrivals[begun:][-STRETCH:]
            if len(frames) == STRETCH and condition(frames):
                return
            late = self.closed is not None or time.monotonic() > deadline
            assert not late, f"never so; {self.closed or Seen(frames, [], PATIENCE) if frames else 'no frames'}"
            time.sleep(0.05)  # between two looks at another thread

    def _run(self) -> None:
        namespaces.enter(self.link.server if self.near else self.link.viewer)
        try:
            asyncio.run(self._watch())
        except (OSError, ConnectionClosed) as error:
            self.closed = repr(error)

    async def _watch(self) -> None:
        url = f"ws://{SERVER}:{PORT}/api/sessions/{self.session}/stream"
        async with connect(url, subprotocols=[Subprotocol(SUBPROTOCOL)], max_size=None, compression=None) as websocket:
            await websocket.send(self.size.model_dump_json())
            self._loop = asyncio.get_running_loop()

            async def read() -> None:
                async for message in websocket:
                    now = time.time()
                    if isinstance(message, str):
                        if json.loads(message)["type"] == "pong" and self._asked_at is not None:
                            self.round_trips.append((now, now - self._asked_at))
                            self._asked_at = None
                        continue
                    frame = Frame.unpack(message)
                    moving = frame.samples == 1
                    took = now - frame.timestamp
                    self.arrivals.append(Arrival(now, took, len(message), frame.width, frame.height, moving))
                    await websocket.send(Ack(sequence=frame.sequence).model_dump_json())

            async def ping() -> None:
                while True:
                    if self._asked_at is None:
                        self._asked_at = time.time()
                        await websocket.send(Ping(time=0).model_dump_json())
                    await asyncio.sleep(PING_SECONDS)

            async def speak() -> None:
                while (message := await self._say.get()) is not None:
                    await websocket.send(message.model_dump_json())

            tasks = [asyncio.create_task(work()) for work in (read, ping, speak)]
            done, waiting = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in waiting:
                task.cancel()
            if tasks[2] not in done:
                self.closed = f"closed: {websocket.close_code} {websocket.close_reason}"


@contextmanager
def server_at(link: Link, *command: str, frames_of: str | None = None) -> Iterator[None]:
    """A culet command that serves at the near end; with `frames_of` behind a stand-in engine of those endpoints."""
    enter = partial(namespaces.enter, link.server)
    address = ["--host", SERVER, "--port", str(PORT), "--allow-host", SERVER, "--no-token"]
    with contextlib.ExitStack() as running:
        if frames_of is not None:
            control, frames = f"ipc://{frames_of}/control", f"ipc://{frames_of}/frames"
            engine = [sys.executable, str(Path(__file__).parent / "ready_engine.py"), control, frames]
            running.enter_context(_ended(subprocess.Popen(engine)))
            command = (*command, "--control", control, "--frames", frames)
        words = [sys.executable, "-m", "culet", *command, *address]
        running.enter_context(_ended(subprocess.Popen(words, preexec_fn=enter)))  # noqa: PLW1509 - enters a namespace
        yield


@contextmanager
def _ended(process: subprocess.Popen[bytes]) -> Iterator[None]:
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(PATIENCE)
        finally:
            process.kill()
            process.wait()


def new_session(link: Link, scene: dict[str, object] | None = None) -> str:
    """Made at the near end, once the server answers."""
    made: list[str] = []

    def make() -> None:
        namespaces.enter(link.server)
        deadline = time.monotonic() + PATIENCE
        while not made and time.monotonic() < deadline:
            with (
                contextlib.suppress(OSError),
                contextlib.closing(HTTPConnection(SERVER, PORT, timeout=PATIENCE)) as connection,
            ):
                body = json.dumps({"scene": scene or {}})
                connection.request("POST", "/api/sessions", body, {"Content-Type": "application/json"})
                answer = connection.getresponse()
                said = answer.read()
                if answer.status == 201:
                    made.append(json.loads(said)["id"])
                else:
                    assert answer.status == 503, said  # it waits for its engine
            time.sleep(0.05)

    thread = threading.Thread(target=make)
    thread.start()
    thread.join()
    assert made, "the server did not answer"
    return made[0]
