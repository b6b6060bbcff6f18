"""The engine: its sockets, and the tasks that serve them."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Coroutine, Sequence
from concurrent.futures import ThreadPoolExecutor

import zmq.asyncio

from culet.engine.capacity.limits import Limits
from culet.engine.capacity.machine import budget
from culet.engine.capacity.memory import Memory
from culet.engine.painting.painter import Painter
from culet.engine.painting.renderer import AnyRenderer
from culet.engine.painting.still import EncodeStill, StillQueue
from culet.engine.painting.video import video_codecs
from culet.engine.process.messages import encoded, read_request, refusal, refusal_by_session
from culet.engine.process.motion_news import MotionNews
from culet.engine.process.requests import Requests
from culet.engine.process.sockets import Peers, bind_control, bind_frames
from culet.engine.process.watchdog import Watchdog
from culet.errors import CuletError, InputError
from culet_protocol import engine as protocol
from culet_protocol.keys import EngineKeys
from culet_protocol.watch import VIDEO_NAMES

log = logging.getLogger(__name__)

HEARTBEAT_SECONDS = 1.0
WAITED_FOR = (
    protocol.Render,
    protocol.Grade,
    protocol.DrawDiagram,
    protocol.Measure,
    protocol.ListTiers,
    protocol.TracePath,
    protocol.PutMesh,
    protocol.PutSky,
)
"""Requests whose work is for who asked alone. Others are quickly done, and meant whether or not somebody waits."""
RETRY_SECONDS = 10.0
"""Until a picture is tried again that something passing was in the way of."""


class EngineServer:
    """Sockets, and the tasks that serve them."""

    def __init__(
        self,
        context: zmq.asyncio.Context,
        control: str,
        frames: Sequence[str],
        limits: Limits,
        renderer: AnyRenderer,
        render_thread: ThreadPoolExecutor,
        encode: EncodeStill,
        keys: EngineKeys | None = None,
    ) -> None:
        self._control = bind_control(context, control, limits.max_upload_bytes, keys)
        self._frames = bind_frames(context, frames, keys)
        self._peers = Peers(self._control, self._give_up)
        self._tasks: set[asyncio.Task[None]] = set()
        self._under_way: dict[tuple[bytes, bytes], asyncio.Task[None]] = {}
        """Requests that are not answered yet, by peer and number."""
        self._waited_for: set[tuple[bytes, bytes]] = set()
        """Those of them that are WAITED_FOR."""
        memory = Memory(budget(limits.memory))
        memory.count("pictures", lambda: renderer.held().get("pictures", 0))
        memory.count("device_skies", lambda: renderer.held().get("device_skies", 0))
        memory.give_back(lambda _: renderer.trim())
        stills = StillQueue(limits.max_stills, limits.max_still_pixels)
        self._painter = Painter(
            renderer,
            render_thread,
            stills,
            send=self._send_frame,
            tell_problem=self._tell_problem,
            encode_still=encode,
            still_seconds=limits.still_seconds,
            rest=limits.rest,
            has_room=lambda size: memory.make_room(size) >= size,
        )
        self._encodes = tuple(VIDEO_NAMES[codec] for codec in video_codecs())
        self._watchdog = Watchdog(render_thread)
        self._orphan_seconds = limits.orphan_seconds
        self._requests = Requests(
            self._painter, stills, limits, dict(renderer.describe()), tell=self._tell, memory=memory,
            forget_sky=lambda sky: renderer.forget(sky.pixels),
        )  # fmt: skip

    async def run_until(self, stopping: asyncio.Event) -> None:
        """Serve until told to stop; an error of the engine itself ends it, so that it is started anew."""
        services = [
            asyncio.create_task(service)
            for service in (
                self._take_requests(),
                self._take_subscriptions(),
                self._beat(),
                MotionNews(self._requests.sessions, self._tell).run(),
                self._painter.run(),
                self._watchdog.run(),
            )
        ]
        stop = asyncio.create_task(stopping.wait())
        try:
            done, _ = await asyncio.wait([*services, stop], return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        finally:
            for task in [*services, stop, *self._tasks]:
                task.cancel()
            await asyncio.gather(*services, stop, *self._tasks, return_exceptions=True)

    async def _take_requests(self) -> None:
        while True:
            # Copying an upload of 64 MiB would hold this loop up for longer than a frame takes.
            sender, *parts = await self._control.recv_multipart(copy=False)
            peer = sender.bytes
            greeting = [len(part) for part in parts] in ([], [0])  # ZMQ_PROBE_ROUTER: somebody connected
            self._peers.heard_from(peer, asks=not greeting)
            if greeting:
                await self._peers.send(peer, [protocol.REQUEST_NUMBER.pack(0), self._heartbeat()])
                continue
            self._answer(peer, parts)

    def _answer(self, peer: bytes, parts: list[zmq.Frame]) -> None:
        task = self._spawn(self._reply(peer, parts))
        request = (peer, parts[0].bytes)
        self._under_way[request] = task

        def forget(_: asyncio.Task[None]) -> None:
            self._under_way.pop(request, None)
            self._waited_for.discard(request)

        task.add_done_callback(forget)

    def _cancel(self, peer: bytes, number: int) -> None:
        task = self._under_way.get((peer, protocol.REQUEST_NUMBER.pack(number)))
        if task is not None:
            task.cancel()

    def _give_up(self, peer: bytes) -> None:
        """A gateway is gone, and with it whoever waited for pictures, for grades and for files to be read."""
        for request in [request for request in self._waited_for if request[0] == peer]:
            if request in self._under_way:
                self._under_way[request].cancel()

    async def _reply(self, peer: bytes, parts: list[zmq.Frame]) -> None:
        number, data = protocol.REQUEST_NUMBER.pack(0), None
        try:
            if len(parts) not in (2, 3) or len(parts[0]) != protocol.REQUEST_NUMBER.size:
                raise InputError(
                    f"expected a request number of 8 bytes, JSON, and bytes or nothing; got parts of "
                    f"{', '.join(str(len(part)) for part in parts)} bytes"
                )
            number = parts[0].bytes
            request = read_request(parts[1].bytes)
            if isinstance(request, protocol.Cancel):
                self._cancel(peer, request.request)
            elif isinstance(request, WAITED_FOR):
                self._waited_for.add((peer, number))
            result, data = await self._requests.answer(request, parts[2].buffer if len(parts) == 3 else None)
            reply = protocol.Reply(result=result)
        except CuletError as error:
            reply = refusal(error)
        except Exception as error:
            log.exception("a request failed")
            reply = refusal(CuletError(f"{type(error).__name__}: {error}"))
        await self._peers.send(peer, [number, encoded(reply), *([] if data is None else [data])])

    async def _take_subscriptions(self) -> None:
        while True:
            message = await self._frames.recv()
            if len(message) == 17 and message[0] in (0, 1):
                topic, subscribed = message[1:], message[0] == 1
                self._requests.sessions.watch(topic, subscribed=subscribed)
                if subscribed and topic.hex() in self._requests.sessions:  # as viewers of protocol 1 ask for frames
                    self._send_frame(refusal_by_session(topic.hex()))

    async def _beat(self) -> None:
        loop = asyncio.get_running_loop()
        seen_at = loop.time()
        while True:
            await self._peers.tell(self._heartbeat())  # which forgets those that left
            if self._peers:
                seen_at = loop.time()
            elif loop.time() - seen_at > self._orphan_seconds:
                self._requests.sessions.close_unwatched()
            await asyncio.sleep(HEARTBEAT_SECONDS)

    def _heartbeat(self) -> bytes:
        return encoded(protocol.Heartbeat(instance=self._requests.instance, encodes=self._encodes))

    def _tell(self, state: protocol.SessionChange | protocol.SessionMotion) -> None:
        self._spawn(self._peers.tell(encoded(state)))

    def _tell_problem(self, session: str, error: CuletError) -> None:
        if error.status == 503:  # it may be gone by itself, as the lack of room for a program
            self._spawn(self._try_again(session))
        problem = protocol.SessionProblem(session=session, title=error.title, detail=str(error))
        self._spawn(self._peers.tell(encoded(problem)))

    async def _try_again(self, session: str) -> None:
        await asyncio.sleep(RETRY_SECONDS)
        live = self._painter.pictures.get(session)
        if live is not None:
            live.try_again()
            self._painter.wake()

    def _send_frame(self, message: bytes) -> None:
        self._spawn(self._send(message))

    async def _send(self, message: bytes) -> None:
        await self._frames.send(message)  # XPUB drops what a full subscriber cannot take, and never waits

    def _spawn(self, work: Coroutine[None, None, None]) -> asyncio.Task[None]:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task
