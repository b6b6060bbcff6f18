"""A real engine process for all of these tests, and for each test a real web server before it, on loopback."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from functools import partial
from pathlib import Path

import pytest

from culet.service.command_lines import engine_command
from gateway.running import PATIENCE, Endpoints, Gateway, engine_process, gateway_before


@pytest.fixture(scope="session")
def engine() -> Iterator[Endpoints]:
    """The endpoints of an engine process."""
    patient = ("--grade-seconds", str(PATIENCE))  # beside other work, more than is answered with what is known by then
    room = ("--max-sessions", "1000")  # the tests' web servers come and go, and leave their sessions to it
    with engine_process(partial(engine_command, options=(*room, *patient))) as endpoints:
        yield endpoints


@pytest.fixture
async def gateway(engine: Endpoints, tmp_path: Path) -> AsyncIterator[Gateway]:
    """A web server that found the engine, and does not give it up where other work keeps it from its heartbeats."""
    async with gateway_before(engine, web=tmp_path, engine_silence_seconds=PATIENCE / 4) as running:
        yield running
