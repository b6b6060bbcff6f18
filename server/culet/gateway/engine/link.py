"""The gateway's side of ZeroMQ: requests to the engine and their replies, what it tells unasked, and frames.

No socket here has ZeroMQ's heartbeats. libzmq 4.3.5 ends the whole process ("Assertion failed: _input_stopped") where a
heartbeat runs out while input stands still at a high-water mark, that is, while this process's loop is held up and
messages keep coming. The engine's own heartbeats tell whether it lives, and the kernel's keep-alive whether its machine
does.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from typing import Any, assert_never

import zmq
import zmq.asyncio
import zmq.utils.monitor
from pydantic import ValidationError

from culet.endpoints import keep_alive
from culet.errors import BusyError, CuletError, EngineUnavailableError, InputError, NotFoundError, TooLargeError
from culet.gateway.engine.engine_door import engine_door_keys
from culet.gateway.settings import GatewaySettings
from culet_protocol.engine import (
    REQUEST_NUMBER,
    Cancel,
    Control,
    Heartbeat,
    Reply,
    SessionChange,
    SessionMotion,
    SessionProblem,
    engine_message,
)
from culet_protocol.frame import Frame, FrameError
from culet_protocol.messages import Message, VideoCodec

log = logging.getLogger(__name__)

FRAMES_WAITING = 16
"""Frames of all sessions in the pipe from the engine. It is emptied at once, into one slot a session."""
RECONNECT_MS = 50
"""Between tries to connect to an engine that is being started again."""
REOPEN_SECONDS = 5.0
"""An engine that was silent for so long, and counts as down, is connected to anew: it may have forgotten this gateway,
and a gateway that is not greeted asks nothing."""

GREET_AGAIN_SECONDS = 1.0
"""After a greeting that an engine which lives did not answer in time."""

_ERROR_OF_STATUS: dict[int, type[CuletError]] = {404: NotFoundError, 429: BusyError, 503: EngineUnavailableError}


class EngineEvents:
    """Who is told what an engine says unasked; this one heeds nothing of it."""

    def frame_came(self, frame: Frame, message: bytes) -> None:
        """A frame, unpacked and as the message that it came in."""

    def session_changed(self, change: SessionChange) -> None:
        """A session is another one than before."""

    def session_moved(self, motion: SessionMotion) -> None:
        """A session's stone moved, or its picture was refined."""

    def session_failed(self, problem: SessionProblem) -> None:
        """A session's picture could not be rendered, or its stone not be moved."""

    def engine_down(self) -> None:
        """The engine does not answer any more."""

    async def engine_up(self, new_process: bool) -> None:
        """The engine answers, maybe as another process than before. Runs in a task of its own."""


class EngineLink:
    """Connects by itself, and again whenever an engine comes. States: down -> up (heartbeats come) -> down (silence).

    `events.engine_up` is called every time the engine answers again after silence, or is another process; by then
    requests are possible. `events.engine_down` is called on silence, or before `engine_up` if the process changed
    without a silence.
    """

    def __init__(self, settings: GatewaySettings) -> None:
        self.ready = asyncio.Event()
        """Set while heartbeats come."""
        self.instance: str | None = None
        self.encodes: tuple[VideoCodec, ...] = ()
        """Video that the engine makes."""
        self.instances = 0
        """Engine processes seen so far."""
        self.frames_received = 0
        self.events = EngineEvents()
        """Told what the engine says unasked."""
        self._settings = settings
        self._keys = engine_door_keys(settings)
        self._last_heard = 0.0
        self._away_since = -float("inf")
        self._greeted: str | None = None
        """The instance that `events.engine_up` was done with last."""
        self._numbers = 0
        self._pending: dict[int, asyncio.Future[tuple[Reply, bytes | memoryview]]] = {}
        self._greeting: asyncio.Task[None] | None = None
        self._context: zmq.asyncio.Context
        self._control: zmq.asyncio.Socket | None = None
        self._frames: zmq.asyncio.Socket | None = None

    async def run(self) -> None:
        """Serve the sockets until cancelled."""
        self._context = zmq.asyncio.Context()
        self._away_since = asyncio.get_running_loop().time()
        try:
            frames = self._context.socket(zmq.SUB)
            keep_alive(frames)
            frames.setsockopt(zmq.RECONNECT_IVL, RECONNECT_MS)
            frames.setsockopt(zmq.RCVHWM, FRAMES_WAITING)
            self._show_keys(frames, self._settings.frames)
            frames.connect(self._settings.frames)
            self._frames = frames
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._read_frames(frames))
                tasks.create_task(self._keep_control())
                tasks.create_task(self._watch())
        finally:
            self._control = self._frames = None
            self.ready.clear()
            self._fail_pending("the gateway is stopping")
            if self._greeting:
                self._greeting.cancel()
            self._context.destroy(linger=0)

    def _show_keys(self, socket: zmq.asyncio.Socket, endpoint: str) -> None:
        if self._keys is not None:
            self._keys.apply(socket, endpoint)

    async def until_up(self) -> None:
        """Wait for an engine that is starting: until it answers, or has been away for `engine_start_seconds`."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout_at(self._away_since + self._settings.engine_start_seconds):
                await self.ready.wait()

    async def _keep_control(self) -> None:
        """A control socket, and another one whenever the engine was silent for long."""
        reopen_seconds = max(REOPEN_SECONDS, self._settings.engine_silence_seconds)  # or requests would fail before
        while True:
            control = self._context.socket(zmq.DEALER)
            control.setsockopt(zmq.LINGER, 0)
            keep_alive(control)
            control.setsockopt(zmq.RECONNECT_IVL, RECONNECT_MS)
            # The probe makes this peer known to the engine. It is sent when a pipe is made; by IMMEDIATE that is at
            # every connection, and nothing that was meant for an engine before waits in it.
            control.setsockopt(zmq.PROBE_ROUTER, 1)
            control.setsockopt(zmq.IMMEDIATE, 1)
            monitor: zmq.asyncio.Socket = control.get_monitor_socket(zmq.EVENT_DISCONNECTED)
            self._show_keys(control, self._settings.control)
            control.connect(self._settings.control)
            self._control = control
            readers = [
                asyncio.create_task(self._read_control(control)),
                asyncio.create_task(self._notice_disconnections(monitor)),
                asyncio.create_task(self._silence(asyncio.get_running_loop().time(), reopen_seconds)),
            ]
            try:
                done, _ = await asyncio.wait(readers, return_when=asyncio.FIRST_COMPLETED)
                for reader in done:
                    reader.result()
            finally:
                self._control = None
                for reader in readers:
                    reader.cancel()
                await asyncio.gather(*readers, return_exceptions=True)
                # Answers go to the socket that asked.
                self._fail_pending("the connection to the render process was made anew")
                control.disable_monitor()
                control.close(linger=0)

    async def _silence(self, since: float, seconds: float) -> None:
        """Return when nothing was heard from the engine for so long, since that time of the loop at the earliest."""
        loop = asyncio.get_running_loop()
        while (left := max(self._last_heard, since) + seconds - loop.time()) > 0:  # noqa: ASYNC110 - until a time that moves
            await asyncio.sleep(left)

    async def _notice_disconnections(self, monitor: zmq.asyncio.Socket) -> None:
        """A process that ends closes its connections: that is known before its silence is."""
        while True:
            await zmq.utils.monitor.recv_monitor_message(monitor)
            self.lose("the connection to the render process broke")

    async def request(
        self,
        message: Message,
        payload: bytes | bytearray | None = None,
        *,
        patient: bool = False,
        for_asker: bool = False,
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        """The engine's result and bytes for a request. `patient` ones may take as long as the engine lives; those
        `for_asker`, as the patient ones, are given up once who asked waits no more.

        Raises what the engine answered as the error of that status, and EngineUnavailableError if it does not answer.
        """
        if self._control is None or not self.ready.is_set():
            if self.instance is None:
                raise EngineUnavailableError("the render process is starting, or cannot be reached; try again later")
            raise EngineUnavailableError("the render process is not running; it should be back in a few seconds")
        self._numbers += 1
        number = self._numbers
        parts: list[bytes | bytearray] = [REQUEST_NUMBER.pack(number), message.model_dump_json().encode()]
        if payload is not None:
            parts.append(payload)
        answer: asyncio.Future[tuple[Reply, bytes | memoryview]] = asyncio.get_running_loop().create_future()
        self._pending[number] = answer
        try:
            # Copying an upload of 64 MiB would hold the streams up for some 70 ms.
            await self._control.send_multipart(parts, flags=zmq.NOBLOCK, copy=False)
            async with asyncio.timeout(None if patient else self._settings.request_seconds):
                reply, data = await answer
        except asyncio.CancelledError:
            if patient or for_asker:  # others are quickly done, and meant whether or not somebody waits for them
                await self._cancel(number)
            raise
        except zmq.Again:
            raise EngineUnavailableError("the render process does not take requests at the moment") from None
        except TimeoutError:
            if isinstance(message, Control) or for_asker:  # who asked is told that it was not done
                await self._cancel(number)
            raise EngineUnavailableError(
                f"the render process did not answer within {self._settings.request_seconds:g} s"
            ) from None
        finally:
            self._pending.pop(number, None)
        if reply.status >= 400:
            raise error_of(reply)
        return reply.result, data

    async def _cancel(self, number: int) -> None:
        """Tell the engine that nobody waits for a request any more; if that fails, work is done in vain."""
        if self._control is None:
            return
        self._numbers += 1
        parts = [REQUEST_NUMBER.pack(self._numbers), Cancel(request=number).model_dump_json().encode()]
        with contextlib.suppress(zmq.ZMQError):
            await self._control.send_multipart(parts, flags=zmq.NOBLOCK)

    def subscribe(self, session: bytes) -> None:
        """Have the frames of a session sent; the engine sends its latest one at once."""
        if self._frames:
            self._frames.setsockopt(zmq.SUBSCRIBE, session)

    def unsubscribe(self, session: bytes) -> None:
        """Undo one `subscribe`."""
        if self._frames:
            self._frames.setsockopt(zmq.UNSUBSCRIBE, session)

    async def _read_frames(self, socket: zmq.asyncio.Socket) -> None:
        # A task of its own that is only ever cancelled at the end: a cancelled recv may lose the message.
        while True:
            message: bytes = await socket.recv()
            try:
                frame = Frame.unpack(message)
            except FrameError as error:
                log.warning("dropped what is not a frame: %s", error)
                continue
            self.frames_received += 1
            self.events.frame_came(frame, message)

    async def _read_control(self, socket: zmq.asyncio.Socket) -> None:
        while True:
            parts: list[zmq.Frame] = await socket.recv_multipart(copy=False)  # a large still takes long to copy
            try:
                (number,) = REQUEST_NUMBER.unpack(parts[0].bytes)
                message = engine_message.validate_json(parts[1].bytes)
            except (IndexError, ValueError, ValidationError) as error:
                log.warning("dropped what is not an engine's message: %s", error)
                continue
            match message:
                case Heartbeat():
                    self.encodes = message.encodes
                    self._hear(message.instance)
                case SessionChange():
                    self.events.session_changed(message)
                case SessionMotion():
                    self.events.session_moved(message)
                case SessionProblem():
                    self.events.session_failed(message)
                case Reply():
                    answer = self._pending.get(number)
                    if answer and not answer.done():
                        answer.set_result((message, parts[2].buffer if len(parts) > 2 else b""))
                        await asyncio.sleep(0)  # whoever asked acts on it before anything that came later is heeded
                case _:
                    assert_never(message)

    def _hear(self, instance: str) -> None:
        self._last_heard = asyncio.get_running_loop().time()
        new = instance != self.instance
        if self.ready.is_set() and not new:
            return
        if self.ready.is_set():
            self.lose("the render process was replaced")
        if new:
            self.instance = instance
            self.instances += 1
        self.ready.set()
        if self._greeting:
            self._greeting.cancel()
        self._greeting = asyncio.create_task(self._greet(instance))

    async def _greet(self, instance: str) -> None:
        while self.ready.is_set():  # or else it went again, and the next one is greeted anew
            try:
                await self.events.engine_up(self._greeted not in (None, instance))
            except EngineUnavailableError as error:
                log.warning("the render process could not be greeted: %s", error)
                await asyncio.sleep(GREET_AGAIN_SECONDS)
            else:
                self._greeted = instance
                return

    async def _watch(self) -> None:
        silence = self._settings.engine_silence_seconds
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(silence / 8)
            if self.ready.is_set() and loop.time() - self._last_heard > silence:
                self.lose(f"the render process was silent for {silence:g} s")

    def lose(self, reason: str) -> None:
        """The caller knows that the engine is gone, and says why."""
        if not self.ready.is_set():
            return
        log.warning("%s", reason)
        self.ready.clear()
        self._away_since = asyncio.get_running_loop().time()
        self._fail_pending(reason)
        self.events.engine_down()

    def _fail_pending(self, reason: str) -> None:
        for answer in self._pending.values():
            if not answer.done():
                answer.set_exception(EngineUnavailableError(reason))
        self._pending.clear()


def error_of(reply: Reply) -> CuletError:
    """The error that a reply with a status of 400 or more reports."""
    detail = reply.detail or json.dumps(reply.result)
    error: CuletError
    if reply.status == 413:
        error = TooLargeError(detail, reply.field)
    elif reply.status in (400, 422):
        error = InputError(detail, reply.field)
    else:
        error = _ERROR_OF_STATUS.get(reply.status, CuletError)(detail)
    if reply.title:
        error.title = reply.title
    return error
