"""Lesser pictures on their whole way: a real engine makes them, and a real gateway says for whom."""

from __future__ import annotations

import asyncio

from culet_protocol.frame import Flags
from culet_protocol.messages import Orbit, Resize
from culet_protocol.watch import LESSER
from gateway.running import Gateway

LARGE, SMALL = Resize(width=320, height=180), Resize(width=64, height=36)


async def test_a_small_window_that_grows_while_nothing_moves_gets_the_picture_in_that_size(gateway: Gateway) -> None:
    session = await gateway.session({"stones": []})
    record = gateway.parts.sessions.get(session)
    async with gateway.viewer(session, size=LARGE) as viewer, gateway.viewer(session, size=SMALL) as other:
        reading = asyncio.create_task(viewer.until(lambda: False))
        try:
            while LESSER not in record.subscribed or other.frames[-1].width != SMALL.width:
                await viewer.say(Orbit(yaw=0.01, pitch=0))
                await other.frame()
            await other.until(lambda: Flags.FINAL in other.frames[-1].flags)
            lesser = other.frames[-1]
            assert lesser.width == SMALL.width
            await other.say(LARGE)
            await other.until(lambda: other.frames[-1].width == LARGE.width and Flags.FINAL in other.frames[-1].flags)
            assert other.frames[-1].sequence > lesser.sequence
        finally:
            reading.cancel()
            await asyncio.gather(reading, return_exceptions=True)
