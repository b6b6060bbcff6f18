"""WS /api/sessions/{id}/stream: admission, then a task that reads and a task that sends.

States: refused (accepted and closed with a code and a reason that a person can read, as a refusal before the handshake
shows a browser nothing but 1006) | streaming -> closed by the viewer, by the end of the session, or for not reading.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from functools import partial
from typing import assert_never

from fastapi import WebSocket, WebSocketDisconnect
from pydantic import ValidationError

from culet.errors import BusyError, CuletError, EngineUnavailableError, InputError, NotFoundError
from culet.gateway.admission.allowance import STREAM_COST
from culet.gateway.answers.problems import check_numbers
from culet.gateway.identity.client_address import client_of
from culet.gateway.identity.origins import may_enter
from culet.gateway.limits.bucket import Bucket
from culet.gateway.sessions.session_record import SessionRecord
from culet.gateway.state import Gateway
from culet.gateway.viewers.viewer import Standing, Viewer
from culet.scene.refusal import scene_error
from culet_protocol import SUBPROTOCOL, VERSION
from culet_protocol.close import CloseCode
from culet_protocol.messages import (
    Ack,
    Decoders,
    Hello,
    Ping,
    Pong,
    Problem,
    Question,
    Resize,
    SessionEvent,
    Visibility,
    control_event,
)
from culet_protocol.watch import VIDEO_OF_NAME

log = logging.getLogger(__name__)

MAX_CONTROL_BYTES = 64 * 1024
SEND_SECONDS = 30.0
"""For one message, the largest of which takes 17 s at 30 kB/s. A viewer that takes longer is gone: a send that was
given up may leave half a frame, so the stream is closed."""
BYTES_PER_COST = 1024
"""So many bytes of a message cost as much as a message: both are what reading one takes, some 30 us."""

EVENT_COST = 2.5
"""Messages that an event of the session costs its viewer: the engine works for it too. 120 a second are one for each
picture of the fastest common screens."""


async def stream(websocket: WebSocket, gateway: Gateway, session_id: str, *, only_watches: bool = False) -> None:
    """Serve one viewer until it leaves; by a session's watch id, or if it `only_watches`, it cannot steer."""
    offered: list[str] = websocket.scope["subprotocols"]
    await websocket.accept(SUBPROTOCOL if SUBPROTOCOL in offered else None)
    client = client_of(websocket.scope)
    bucket = gateway.clients.of(client, time.monotonic())
    while (wait := bucket.overdrawn_for(time.monotonic())) > 0:  # noqa: ASYNC110 - time is what is waited for
        await asyncio.sleep(wait)
    bucket.spend(STREAM_COST, time.monotonic())
    if not may_enter(websocket.scope, gateway.settings.allow_origin):
        await websocket.close(
            CloseCode.FORBIDDEN_ORIGIN, f"pages of {websocket.headers['origin'][:60]} may not open streams here"
        )
        return
    if offered and SUBPROTOCOL not in offered:
        await websocket.close(
            CloseCode.PROTOCOL_ERROR,
            f"this server speaks {SUBPROTOCOL}; reload the page, or use its own client",
        )
        return
    await gateway.sessions.settle(session_id)
    try:
        session = gateway.sessions.get(session_id)
        steers = session.id == session_id and not only_watches
        viewer = gateway.sessions.join(session, client, steers=steers)
    except NotFoundError:
        await websocket.close(CloseCode.UNKNOWN_SESSION, "no such session; it may have expired")
        return
    except EngineUnavailableError as error:
        await websocket.close(CloseCode.SERVICE_RESTART, str(error))
        return
    except BusyError as error:
        await websocket.close(CloseCode.BUSY, str(error))
        return
    try:
        watch = session.topic.hex()
        named = session.id if viewer.steers else watch
        encodes = gateway.link.encodes
        hello = Hello(
            protocol=VERSION, session=named, watch=watch, viewer=viewer.number, steers=viewer.steers, encodes=encodes
        )
        await websocket.send_text(hello.model_dump_json())
        await _Stream(websocket, gateway, session, viewer, bucket).run()
    except (WebSocketDisconnect, RuntimeError):  # starlette raises either for a send after the viewer left
        pass
    finally:
        gateway.sessions.leave(session, viewer)


QUESTIONS_UNDER_WAY = 8
"""Questions of one viewer that the engine has not answered. They take no room of the session's events: whoever only
watches must not hold up who steers."""


class _Stream:
    """The two tasks of one viewer."""

    def __init__(
        self, websocket: WebSocket, gateway: Gateway, session: SessionRecord, viewer: Viewer, client: Bucket
    ) -> None:
        self._websocket = websocket
        self._gateway = gateway
        self._session = session
        self._viewer = viewer
        self._messages = Bucket(gateway.settings.viewer_messages_per_second)
        """What the viewer may still say."""
        self._client = client
        """What its client may still ask for."""
        self._questions = asyncio.Semaphore(QUESTIONS_UNDER_WAY)
        """Held for each question until the engine has answered."""
        self._under_way: set[asyncio.Task[None]] = set()
        self._number = 0
        """Of the viewer's message that was read last."""

    async def run(self) -> None:
        """Until either task ends."""
        # A reader always reads: that is how a viewer that leaves, and the server's shutdown, are noticed.
        reader, sender = asyncio.create_task(self._read()), asyncio.create_task(self._send())
        try:
            done, _ = await asyncio.wait({reader, sender}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            tasks = [reader, sender, *self._under_way]
            for task in tasks:
                task.cancel()
            results = await asyncio.gather(*tasks, return_exceptions=True)
        if sender in done and reader not in done:
            # A close waits, as a send does, for room that a viewer makes by reading; some viewers never read.
            with contextlib.suppress(RuntimeError, TimeoutError):
                async with asyncio.timeout(SEND_SECONDS):
                    await self._websocket.close(*self._reason())
        for result in results[:2]:
            if isinstance(result, Exception):
                raise result

    def _reason(self) -> tuple[int, str]:
        match self._viewer.standing:
            case Standing.DISMISSED:
                return CloseCode.UNKNOWN_SESSION, "the session has ended"
            case Standing.STOPPING:
                return CloseCode.SERVICE_RESTART, "the server is stopping, or being restarted"
            case Standing.OVERRUN | Standing.ATTENDING:  # a send took too long
                return CloseCode.TOO_SLOW, "this viewer does not read what it is sent"
            case _:
                assert_never(self._viewer.standing)

    async def _send(self) -> None:
        viewer = self._viewer
        while viewer.standing is not Standing.OVERRUN:
            viewer.wake.clear()
            while (notice := viewer.next_notice(time.monotonic())) is not None:
                if not await self._in_time(notice.model_dump_json()):
                    return
            if viewer.standing in (Standing.DISMISSED, Standing.STOPPING):
                return
            frame = viewer.next_frame(time.monotonic())
            if frame is not None:
                if not await self._in_time(frame):
                    return
                self._gateway.metrics.frame_sent(len(frame))
                self._gateway.sessions.video_taken(self._session)
                continue  # notices may have come, and another frame
            until = viewer.sleep_until()
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(None if until is None else max(0.0, until - time.monotonic())):
                    await viewer.wake.wait()

    async def _in_time(self, message: str | bytes) -> bool:
        sending = (
            self._websocket.send_text(message) if isinstance(message, str) else self._websocket.send_bytes(message)
        )
        try:
            async with asyncio.timeout(SEND_SECONDS):
                await sending
        except TimeoutError:
            log.info("viewer %d does not read; closing", self._viewer.number)
            return False
        return True

    async def _read(self) -> None:
        while True:
            await self._rest()
            message = await self._websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            text: str | None = message.get("text")
            size = len(message["bytes"]) if text is None else len(text.encode())
            self._pay(min(size, MAX_CONTROL_BYTES))
            self._number += 1
            if text is None:
                self._refuse("binary_message", "control messages are JSON text; binary ones are for frames")
                continue
            if size > MAX_CONTROL_BYTES:
                self._refuse(
                    "too_large", f"expected a control message of at most {MAX_CONTROL_BYTES} bytes, got {size}"
                )
                continue
            try:
                event = control_event.validate_json(text)
                check_numbers(event)
            except ValidationError as error:
                finding = scene_error(error)
                self._refuse("malformed", str(finding), finding.field)
                continue
            except InputError as error:
                self._refuse("unusable_input", str(error), error.field)
                continue
            if isinstance(event, SessionEvent) and not self._viewer.steers:
                self._refuse("only_watching", "this link lets watch the session; whoever has its other link changes it")
                continue
            if isinstance(event, SessionEvent | Question):
                self._messages.spend(EVENT_COST - 1, time.monotonic())
                room = self._session.room if isinstance(event, SessionEvent) else self._questions
                await room.acquire()
                # Not awaited: events travel in order on the engine's socket without waiting for each other.
                task = asyncio.create_task(self._bring(event, self._number))
                self._under_way.add(task)
                task.add_done_callback(partial(self._done, room))
            else:
                self._heed(event)

    async def _rest(self) -> None:
        """Leave what comes in the socket, whose other end then has to wait, until there is allowance for it."""
        while (wait := self._overdrawn_for(time.monotonic())) > 0:  # noqa: ASYNC110 - time is what is waited for
            await asyncio.sleep(wait)

    def _overdrawn_for(self, now: float) -> float:
        return max(self._messages.overdrawn_for(now), self._client.overdrawn_for(now))

    def _pay(self, size: int) -> None:
        """For a message of that many bytes, whatever it says: a refusal costs what reading it cost."""
        now, cost = time.monotonic(), 1 + size / BYTES_PER_COST
        self._messages.spend(cost, now)
        self._client.spend(cost, now)

    def _heed(self, event: Resize | Visibility | Ack | Decoders | Ping) -> None:
        match event:
            case Ack(sequence=sequence):
                stalled = self._viewer.credit.stalled(time.monotonic())
                self._viewer.acknowledge(sequence, time.monotonic())
                if stalled:
                    self._gateway.sessions.update_demand(self._session)
            case Decoders(codecs=codecs):
                known = [codec for codec in codecs if codec in self._gateway.link.encodes]
                self._viewer.feed.follow(VIDEO_OF_NAME[known[0]] if known else None)
                self._gateway.sessions.update_demand(self._session)
            case Ping(time=sent):
                self._viewer.tell(Pong(time=sent))
            case Resize(width=width, height=height):
                self._viewer.resize(width, height)
                self._gateway.sessions.update_demand(self._session)
            case Visibility(visible=visible):
                self._viewer.show(visible, time.monotonic())
                self._gateway.sessions.update_demand(self._session)
            case _:
                assert_never(event)

    def _done(self, room: asyncio.Semaphore, task: asyncio.Task[None]) -> None:
        # Here and not in the task: one that is cancelled before it began runs no `finally`.
        self._under_way.discard(task)
        room.release()

    async def _bring(self, event: SessionEvent | Question, number: int) -> None:
        """To the engine."""
        try:
            if isinstance(event, SessionEvent):
                await self._gateway.sessions.apply(self._session, event)
            else:
                self._viewer.tell(await self._gateway.sessions.ask(self._session, event))
        except InputError as error:
            self._refuse("unusable_input", str(error), error.field, number)
        except CuletError as error:
            self._refuse(error.title.replace(" ", "_"), str(error), None, number)

    def _refuse(self, code: str, message: str, field: str | None = None, number: int | None = None) -> None:
        """The viewer's message of that number, or else the one that was read last."""
        self._viewer.tell(Problem(code=code, message=message, field=field, number=number or self._number))
