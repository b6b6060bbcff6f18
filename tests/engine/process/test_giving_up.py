"""What nobody waits for any more, because its gateway is gone, is given up."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import zmq.asyncio

from culet.engine.capacity.limits import Limits
from culet.engine.process.engine import EngineServer
from culet.engine.process.serve import encode_still
from engine.peer import PATIENCE, Peer
from engine.process.test_failures import FailingRenderer


@pytest.mark.parametrize(
    "request_", [{"type": "render"}, {"type": "grade"}, {"type": "draw_diagram"}, {"type": "trace_path"}]
)
async def test_work_for_a_gateway_that_is_gone_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request_: dict[str, Any]
) -> None:
    begun, given_up = asyncio.Event(), asyncio.Event()

    async def endless(*_: object) -> None:
        begun.set()
        try:
            await asyncio.Event().wait()
        finally:
            given_up.set()

    control, frames = f"ipc://{tmp_path}/control", f"ipc://{tmp_path}/frames"
    context, stopping, thread = zmq.asyncio.Context(), asyncio.Event(), ThreadPoolExecutor(1)
    engine = EngineServer(context, control, [frames], Limits(), FailingRenderer(), thread, encode_still)
    monkeypatch.setattr(engine._requests, "answer", endless)
    running = asyncio.create_task(engine.run_until(stopping))
    gateways = zmq.asyncio.Context()
    try:
        gateway = Peer(gateways, control)
        async with asyncio.timeout(PATIENCE):
            gateway.ask_later(**request_)
            await begun.wait()
            assert not given_up.is_set()
            gateway.reader.cancel()
            gateways.destroy(linger=0)
            await given_up.wait()
    finally:
        stopping.set()
        await running
        thread.shutdown()
        context.destroy(linger=0)
