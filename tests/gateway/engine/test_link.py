"""The gateway's requests, and an engine that does not answer them."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
import zmq
import zmq.asyncio

from culet.errors import EngineUnavailableError
from culet.gateway.engine.link import EngineLink
from culet.gateway.settings import GatewaySettings
from culet_protocol.engine import (
    REQUEST_NUMBER,
    Cancel,
    CloseSession,
    Control,
    Heartbeat,
    OpenSession,
    Reply,
    Status,
    engine_request,
)
from culet_protocol.messages import Message, Undo
from shared.patience import PATIENCE

SESSION = "a" * 32
LOST = OpenSession(session=SESSION, scene={}, snapshot={})


class SilentEngine:
    """Hears what a link says, and answers nothing but what it is told to."""

    def __init__(self, socket: zmq.asyncio.Socket) -> None:
        self._socket = socket
        self.peer = b""
        """Who spoke last."""

    async def say(self, number: int, message: Message) -> None:
        await self._socket.send_multipart([self.peer, REQUEST_NUMBER.pack(number), message.model_dump_json().encode()])

    async def greet(self) -> None:
        """Wait for a connection, and tell that there is an engine."""
        self.peer, *_ = await self._socket.recv_multipart()
        await self.say(0, Heartbeat(instance="1"))

    async def heard(self) -> tuple[int, Message]:
        """The next request, with its number."""
        self.peer, number, request = await self._socket.recv_multipart()
        return REQUEST_NUMBER.unpack(number)[0], engine_request.validate_json(request)


@pytest.fixture(autouse=True)
def silent(monkeypatch: pytest.MonkeyPatch) -> asyncio.Event:
    """Set, it has the engine been silent for so long that links connect anew; by itself that never comes."""
    event = asyncio.Event()

    async def silence(*_: object) -> None:
        await event.wait()
        event.clear()

    monkeypatch.setattr(EngineLink, "_silence", silence)
    return event


@asynccontextmanager
async def linked(folder: Path, request_seconds: float) -> AsyncIterator[tuple[EngineLink, SilentEngine]]:
    """A link that is ready, and the engine that it speaks with."""
    control = f"ipc://{folder}/control"
    context = zmq.asyncio.Context()
    socket = context.socket(zmq.ROUTER)
    socket.bind(control)
    link = EngineLink(
        GatewaySettings(
            control=control,
            frames=f"ipc://{folder}/frames",
            request_seconds=request_seconds,
            engine_silence_seconds=PATIENCE,
        )
    )
    running = asyncio.create_task(link.run())
    try:
        async with asyncio.timeout(PATIENCE):
            engine = SilentEngine(socket)
            await engine.greet()
            await link.ready.wait()
            yield link, engine
    finally:
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        context.destroy(linger=0)


async def test_a_change_that_its_sender_is_told_was_not_done_is_given_up(tmp_path: Path) -> None:
    """And nothing else is: what it is for may be done all the same."""
    async with linked(tmp_path, request_seconds=0.01) as (link, engine):
        change = Control(session=SESSION, event=Undo())
        for message, for_asker in ((Status(), False), (LOST, False), (change, False), (LOST, True)):
            with pytest.raises(EngineUnavailableError, match="did not answer within"):
                await link.request(message, for_asker=for_asker)
        came = [await engine.heard() for _ in range(6)]
        assert [type(request) for _, request in came] == [Status, OpenSession, Control, Cancel, OpenSession, Cancel]
        for (number, _), (_, cancel) in (came[2:4], came[4:6]):
            assert isinstance(cancel, Cancel)
            assert cancel.request == number


async def test_a_session_that_nobody_waits_to_open_is_given_up_unless_the_gateway_has_it(tmp_path: Path) -> None:
    async with linked(tmp_path, request_seconds=PATIENCE) as (link, engine):
        numbers = []
        for message, for_asker in ((LOST, False), (CloseSession(session=SESSION), False), (LOST, True)):
            asking = asyncio.create_task(link.request(message, for_asker=for_asker))
            number, heard = await engine.heard()
            assert heard == message
            numbers.append(number)
            asking.cancel()
            await asyncio.gather(asking, return_exceptions=True)
        _, cancel = await engine.heard()
        assert cancel == Cancel(request=numbers[-1])


async def test_what_was_asked_by_a_connection_that_is_gone_is_not_waited_for(
    tmp_path: Path, silent: asyncio.Event
) -> None:
    """An engine answers to the connection that asked, which another one does not hear."""
    async with linked(tmp_path, request_seconds=PATIENCE) as (link, engine):
        asking = asyncio.create_task(link.request(Status(), patient=True))
        await engine.heard()
        before = engine.peer
        silent.set()
        with pytest.raises(EngineUnavailableError, match="was made anew"):
            await asking
        await engine.greet()
        assert engine.peer != before
        assert link.ready.is_set(), "the engine was not silent for long enough to count as gone"
        asking = asyncio.create_task(link.request(Status()))
        number, _ = await engine.heard()
        await engine.say(number, Reply(status=200, result={"sessions": 0}))
        assert (await asking)[0] == {"sessions": 0}


async def test_an_engine_that_does_not_count_as_down_yet_is_not_connected_to_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waited: list[float] = []

    async def silence(_: EngineLink, __: float, seconds: float) -> None:
        waited.append(seconds)
        await asyncio.Event().wait()

    monkeypatch.setattr(EngineLink, "_silence", silence)
    async with linked(tmp_path, request_seconds=PATIENCE):
        assert waited == [PATIENCE], "the link's own silence"
