"""A real engine, and sessions and stills that would take all of its time if it let them."""

from __future__ import annotations

import asyncio
from typing import Any

from culet_protocol.frame import Flags
from engine.peer import PATIENCE, EngineProcess, Peer, connected

DEAREST: dict[str, Any] = {
    "optics": {"bands": 64, "polarised": True, "cutoff": 1e-9, "max_bounces": 65536},
    "walls": {"kind": "mirror"},
    "floor": {"kind": "mirror"},
    "stones": [{"material": {"ior": [10, 10, 10]}}],
}
"""One frame of 64 x 64 pixels takes some 10 s of two cores."""
CHEAP: dict[str, Any] = {
    "floor": {"kind": "none"},
    "emitters": [],
    "environment": {"kind": "dark"},
    "simulation": {"sleeping": False},
}


async def test_a_session_that_asks_for_everything_keeps_no_other_from_its_frames(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        dear = watch(await peer.open(DEAREST))
        await peer.demand(width=640, height=360)
        await peer.control("balance", exactness=1, pinned=True)
        await peer.control("toggle_fall")
        before = (await peer.status())["render_hold_seconds"]
        cheap = watch(await peer.open(CHEAP))
        await peer.demand()
        await peer.control("toggle_fall")
        steps: dict[int, int] = {}  # by the frame's number: one that no other follows for a second is sent again
        while len(steps) < 15:
            frame = await cheap.until(lambda frame: Flags.MOVING in frame.flags)
            steps[frame.sequence] = frame.step
        assert len(set(steps.values())) == 15, "a picture each, none drawn twice"
        seen = await dear.until(lambda frame: Flags.MOVING in frame.flags)
        assert seen.bands == 3, "what it pinned is beyond reach, so that it is governed, and seen"
        after = (await peer.status())["render_hold_seconds"]
        held = [more - fewer for more, fewer in zip(after["counts"], before["counts"], strict=True)]
        assert sum(held) > 50, "what takes seconds was done piece by piece"


async def _stills_waiting(peer: Peer, number: int) -> None:
    """Wait until so many do."""
    async with asyncio.timeout(PATIENCE):
        while (await peer.status())["stills_waiting"] != number:  # noqa: ASYNC110 - another process knows
            await asyncio.sleep(0.05)


async def test_a_still_that_is_cancelled_frees_its_place_and_the_render_thread(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        waiting = peer.ask_later(
            type="render", scene=DEAREST | {"sampling": {"samples_per_pixel": 16}}, width=2048, height=2048, client="a"
        )
        number = peer.number
        await _stills_waiting(peer, 1)
        await peer.result(type="cancel", request=number)
        await _stills_waiting(peer, 0)
        assert not waiting.done()
        pictures = (await peer.status())["memory_pictures_bytes"]
        assert pictures < 2048 * 2048 * 32 * 2, "its sums are given back, or kept for the next picture only"
        assert (await peer.ask(type="render", scene=CHEAP, width=16, height=16, samples=1))["status"] == 200


async def test_an_engine_that_draws_nothing_gives_back_the_memory_of_pictures(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        assert (await peer.ask(type="render", scene=CHEAP, width=256, height=256, samples=1))["status"] == 200
        async with asyncio.timeout(PATIENCE):
            while (await peer.status())["memory_pictures_bytes"] > 0:  # noqa: ASYNC110 - another process knows
                await asyncio.sleep(0.05)


async def test_what_a_gateway_waits_for_that_was_killed_is_given_up(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        async with connected(engine) as (other, _):
            other.ask_later(
                type="render", scene=DEAREST | {"sampling": {"samples_per_pixel": 16}}, width=2048, height=2048
            )
            await _stills_waiting(peer, 1)
        await _stills_waiting(peer, 0)


async def test_a_still_that_is_more_work_than_one_may_make_is_refused_by_its_numbers(engine: EngineProcess) -> None:
    scene = {"sampling": {"samples_per_pixel": 65536}, "optics": {"bands": 64}}
    async with connected(engine) as (peer, _):
        reply = await peer.ask(type="render", scene=scene, width=1024, height=1024)
        assert (reply["status"], reply["field"]) == (422, "samples")
        assert "1024 x 1024 x 65536 x 64" in reply["detail"]
        assert (await peer.status())["stills_waiting"] == 0
