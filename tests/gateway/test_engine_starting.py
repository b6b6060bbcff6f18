"""An engine that is starting, or answers late, is waited for."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import zmq.asyncio

from culet.errors import EngineUnavailableError
from culet.gateway.engine import link as links
from culet.gateway.engine.link import EngineEvents, EngineLink
from culet.gateway.settings import GatewaySettings
from culet_protocol.engine import REQUEST_NUMBER, Heartbeat
from gateway.running import PATIENCE, Endpoints, Gateway, gateway_alone


async def test_a_new_session_waits_for_an_engine_that_is_about_to_answer(gateway: Gateway) -> None:
    gateway.parts.link.lose("said by a test")  # until its next heartbeat
    assert not gateway.parts.link.ready.is_set()
    made = await gateway.http.post("/api/sessions", json={})
    assert made.status_code == 201, made.text


async def test_a_new_session_is_refused_once_the_engine_has_been_away_for_long() -> None:
    async with gateway_alone(engine_start_seconds=0.5) as gateway:
        refused = await gateway.http.post("/api/sessions", json={})
    assert (refused.status_code, "starting" in refused.json()["detail"]) == (503, True)


@pytest.fixture
async def greetings(engine: Endpoints) -> AsyncIterator[list[bool]]:
    """What a link says that comes up, if the first greeting gets no answer."""
    said: list[bool] = []
    link = EngineLink(GatewaySettings(control=engine.control, frames=engine.frames))

    class Busy(EngineEvents):
        async def engine_up(self, new_process: bool) -> None:
            said.append(new_process)
            if len(said) == 1:
                raise EngineUnavailableError("too busy to answer")

    link.events = Busy()
    running = asyncio.create_task(link.run())
    try:
        yield said
    finally:
        running.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await running


async def test_an_engine_that_did_not_answer_a_greeting_in_time_is_greeted_again(greetings: list[bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while len(greetings) < 2:  # noqa: ASYNC110 - the engine's heartbeats come by themselves
            await asyncio.sleep(0.01)
    assert greetings == [False, False]


async def test_an_engine_that_falls_silent_counts_as_down_however_often_it_is_connected_to_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each new connection had counted as a word of the engine."""
    monkeypatch.setattr(links, "REOPEN_SECONDS", 0.1)
    control, frames = f"ipc://{tmp_path}/c", f"ipc://{tmp_path}/f"
    link = EngineLink(GatewaySettings(control=control, frames=frames, engine_silence_seconds=1.1))
    with zmq.asyncio.Context() as context, context.socket(zmq.ROUTER) as engine:
        engine.setsockopt(zmq.LINGER, 0)
        engine.bind(control)
        running = asyncio.create_task(link.run())
        try:
            async with asyncio.timeout(PATIENCE):
                heartbeat = Heartbeat(instance="one").model_dump_json().encode()
                while not link.ready.is_set():  # an answer may come to a socket that the link has closed meanwhile
                    gateway, *_ = await engine.recv_multipart()
                    await engine.send_multipart([gateway, REQUEST_NUMBER.pack(0), heartbeat])
                again, *_ = await engine.recv_multipart()
                assert again != gateway
                while link.ready.is_set():  # noqa: ASYNC110 - the link itself finds out
                    await asyncio.sleep(0.01)
        finally:
            running.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await running
