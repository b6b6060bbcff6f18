"""The engine's process: `culet engine` calls `run`, which returns at SIGTERM or SIGINT."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import sys
import threading
from collections.abc import Callable, Coroutine, Sequence
from concurrent.futures import ThreadPoolExecutor

import zmq
import zmq.asyncio
from pydantic import BaseModel, ValidationError

from culet.engine.drawing import Picture, Renderer
from culet.engine.limits import Limits
from culet.engine.machine import budget
from culet.engine.memory import Memory
from culet.engine.painter import Painter
from culet.engine.requests import Requests
from culet.engine.sockets import Peers, bind_control, bind_frames
from culet.engine.still import StillQueue
from culet.engine.watchdog import Watchdog
from culet.errors import CuletError, InputError
from culet.scene.model import scene_error
from culet_protocol import engine as protocol

log = logging.getLogger(__name__)

HEARTBEAT_SECONDS = 1.0
WAITED_FOR = (protocol.Render, protocol.PutMesh, protocol.PutSky)
"""Requests whose work is for who asked alone. Others are quickly done, and meant whether or not somebody waits."""
RETRY_SECONDS = 10.0
"""Until a picture is tried again that something passing was in the way of."""


def run(control: str, frames: Sequence[str], limits: Limits | None = None, *, stand_by: bool = False) -> None:
    """Serve until SIGTERM or SIGINT: control at one endpoint, frames at each of some. The process may end with it.

    With `stand_by` it gets everything ready but its sockets, and then waits for a line on the standard input.
    DeviceError without a working device, InputError for a bad endpoint.
    """
    start = asyncio.Event()
    asyncio.run(_run(control, frames, limits or Limits(), start, stand_by=stand_by))
    _end_beside_compilers()


def _end_beside_compilers() -> None:
    """End the process here if a thread still compiles, or whatever else nobody waits for.

    Python ends such a thread, when it comes back to Python, by unwinding its stack. In a driver's C++ that is
    `std::terminate`, and the process would abort.
    """
    if any(thread.daemon for thread in threading.enumerate()):
        logging.shutdown()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)


async def _run(control: str, frames: Sequence[str], limits: Limits, start: asyncio.Event, *, stand_by: bool) -> None:
    loop = asyncio.get_running_loop()

    def begin() -> None:
        loop.remove_reader(sys.stdin)  # the line, and the end of a closed input, would wake the loop for ever
        start.set()

    if stand_by:
        loop.add_reader(sys.stdin, begin)
    else:
        start.set()
    await serve(control, frames, limits, open_renderer, encode_still, start)
    if stand_by:
        loop.remove_reader(sys.stdin)


def open_renderer() -> Renderer:
    """The OpenCL renderer, its special programs compiled while the general one serves.

    It is imported here, so that whatever only speaks to an engine never loads it.
    """
    import culet.rendering.files  # so that the first still needs not wait for it  # noqa: F401
    from culet.rendering import kernel_cache
    from culet.rendering.renderer import Renderer as OpenClRenderer

    if not kernel_cache.has_plenty_of_room() and (fault := kernel_cache.complaint()):
        log.error("%s", fault)  # said first: the compiler may end this process
    renderer = OpenClRenderer(background_compile=True)
    try:
        renderer.prepare()
    except CuletError as error:  # what needs these programs says so itself, and other work goes on
        log.error("%s", error)
    return renderer


def encode_still(picture: Picture, file_format: str) -> bytes:
    """A still in its file format."""
    from culet.rendering.files import encode
    from culet.rendering.renderer import Picture as OpenClPicture

    assert isinstance(picture, OpenClPicture)  # noqa: S101 - made by `open_renderer`
    return encode(picture, file_format)


async def serve(
    control: str,
    frames: Sequence[str],
    limits: Limits,
    renderer_of: Callable[[], Renderer],
    encode: Callable[[Picture, str], bytes],
    start: asyncio.Event | None = None,
) -> None:
    """Serve with a renderer that is made and used on the render thread, once `start` is set."""
    loop = asyncio.get_running_loop()
    stopping = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, stopping.set)
    render_thread = ThreadPoolExecutor(1, "render")
    context = zmq.asyncio.Context()
    try:
        renderer = await loop.run_in_executor(render_thread, renderer_of)
        if start is not None and not await _first(start, stopping):
            return
        engine = Engine(context, control, frames, limits, renderer, render_thread, encode)
        await engine.run_until(stopping)
    finally:
        render_thread.shutdown(wait=False, cancel_futures=True)
        context.destroy(linger=0)


async def _first(event: asyncio.Event, other: asyncio.Event) -> bool:
    """Wait for the first of two events; whether the one is set, and not the other."""
    waiting = [asyncio.create_task(waited.wait()) for waited in (event, other)]
    await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
    for task in waiting:
        task.cancel()
    return not other.is_set()


class Engine:
    """Sockets, and the tasks that serve them."""

    def __init__(
        self,
        context: zmq.asyncio.Context,
        control: str,
        frames: Sequence[str],
        limits: Limits,
        renderer: Renderer,
        render_thread: ThreadPoolExecutor,
        encode: Callable[[Picture, str], bytes],
    ) -> None:
        self._control = bind_control(context, control, limits.max_upload_bytes)
        self._frames = bind_frames(context, frames)
        self._peers = Peers(self._control, self._give_up)
        self._tasks: set[asyncio.Task[None]] = set()
        self._under_way: dict[tuple[bytes, bytes], asyncio.Task[None]] = {}
        """Requests that are not answered yet, by peer and number."""
        self._waited_for: set[tuple[bytes, bytes]] = set()
        """Those of them that are WAITED_FOR."""
        stills = StillQueue(limits.max_stills, limits.max_still_pixels)
        self._painter = Painter(
            renderer,
            render_thread,
            stills,
            send=self._send_frame,
            report=self._report_problem,
            encode_still=encode,
            still_seconds=limits.still_seconds,
        )
        self._watchdog = Watchdog(render_thread)
        self._orphan_seconds = limits.orphan_seconds
        memory = Memory(budget(limits.memory))
        memory.count("pictures", lambda: renderer.held().get("pictures", 0))
        memory.count("device_skies", lambda: renderer.held().get("device_skies", 0))
        memory.give_back(lambda _: renderer.release())
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
                self._requests.report_motion(),
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
        """A gateway is gone, and with it whoever waited for pictures and for files to be read."""
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
                self._requests.watch(message[1:], subscribed=message[0] == 1)

    async def _beat(self) -> None:
        loop = asyncio.get_running_loop()
        seen_at = loop.time()
        while True:
            await self._peers.tell(self._heartbeat())  # which forgets those that left
            if self._peers:
                seen_at = loop.time()
            elif loop.time() - seen_at > self._orphan_seconds:
                self._requests.close_unwatched()
            await asyncio.sleep(HEARTBEAT_SECONDS)

    def _heartbeat(self) -> bytes:
        return encoded(protocol.Heartbeat(instance=self._requests.instance))

    def _tell(self, state: protocol.SessionState | protocol.SessionMotion) -> None:
        self._spawn(self._peers.tell(encoded(state)))

    def _report_problem(self, session: str, error: CuletError) -> None:
        if error.status == 503:  # it may be gone by itself, as the lack of room for a program
            self._spawn(self._try_again(session))
        problem = protocol.SessionProblem(session=session, title=error.title, detail=str(error))
        self._spawn(self._peers.tell(encoded(problem)))
        live = self._painter.pictures.get(session)
        if live is not None:  # its stone may have stopped
            self._tell(live.session.report(edited=True))

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


def read_request(text: bytes) -> protocol.Request:
    """The request, or InputError that names the first field that cannot be used."""
    try:
        return protocol.engine_request.validate_json(text)
    except ValidationError as error:
        found = scene_error(error)
        raise InputError(f"request: {found}", found.field) from error


def refusal(error: CuletError) -> protocol.Reply:
    """The reply that says why not."""
    return protocol.Reply(
        status=error.status, title=error.title, detail=str(error), field=getattr(error, "field", None)
    )


def encoded(message: BaseModel) -> bytes:
    """JSON."""
    return message.model_dump_json().encode()
