"""An engine that is starting, or answers late, is waited for."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator

import pytest

from culet.errors import EngineUnavailableError
from culet.gateway.link import EngineEvents, EngineLink
from culet.gateway.settings import GatewaySettings
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
