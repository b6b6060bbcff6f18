"""The gateway's requests, and an engine that does not answer them."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
import zmq
import zmq.asyncio

from culet.errors import EngineUnavailableError
from culet.gateway.link import EngineLink
from culet.gateway.settings import GatewaySettings
from culet_protocol.engine import REQUEST_NUMBER, Cancel, Control, Heartbeat, Status, engine_request
from culet_protocol.messages import Undo
from shared.patience import PATIENCE


async def test_a_change_that_its_sender_is_told_was_not_done_is_given_up(tmp_path: Path) -> None:
    """And nothing else is: what it is for may be done all the same."""
    control = f"ipc://{tmp_path}/control"
    context = zmq.asyncio.Context()
    engine = context.socket(zmq.ROUTER)
    engine.bind(control)
    settings = GatewaySettings(
        control=control, frames=f"ipc://{tmp_path}/frames", request_seconds=0.01, engine_silence_seconds=PATIENCE
    )
    link = EngineLink(settings)
    running = asyncio.create_task(link.run())
    try:
        async with asyncio.timeout(PATIENCE):
            peer, *_ = await engine.recv_multipart()
            heartbeat = Heartbeat(instance="1", encodes=()).model_dump_json().encode()
            await engine.send_multipart([peer, REQUEST_NUMBER.pack(0), heartbeat])
            await link.ready.wait()
            for message in (Status(), Control(session="a" * 32, event=Undo())):
                with pytest.raises(EngineUnavailableError, match="did not answer within"):
                    await link.request(message)
            came = [await engine.recv_multipart() for _ in range(3)]
        assert [type(engine_request.validate_json(parts[2])) for parts in came] == [Status, Control, Cancel]
        cancel = engine_request.validate_json(came[2][2])
        assert isinstance(cancel, Cancel)
        assert REQUEST_NUMBER.pack(cancel.request) == came[1][1]
    finally:
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        context.destroy(linger=0)
