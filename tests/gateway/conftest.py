"""A real engine process for all of these tests, and for each test a real web server before it, on loopback."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest

from culet.gateway.supervisor import engine_command
from gateway.running import Endpoints, Gateway, gateway_before


@pytest.fixture(scope="session")
def engine() -> Iterator[Endpoints]:
    """The endpoints of an engine process."""
    with tempfile.TemporaryDirectory(prefix="culet-test-") as folder:  # pytest's own folders can be too long for ipc
        endpoints = Endpoints(f"ipc://{folder}/control", f"ipc://{folder}/frames")
        process = subprocess.Popen(engine_command(*endpoints))
        try:
            yield endpoints
        finally:
            process.terminate()
            assert process.wait(10) == 0


@pytest.fixture
async def gateway(engine: Endpoints, tmp_path: Path) -> AsyncIterator[Gateway]:
    """A web server that found the engine."""
    async with gateway_before(engine, web=tmp_path) as running:
        yield running
