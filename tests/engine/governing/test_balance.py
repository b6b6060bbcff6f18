"""The balance between speed and exactness, in a real engine."""

from __future__ import annotations

import asyncio
import json
import math

import pytest

from culet.engine.governing.governor import ERRORS, read_ladder
from culet.engine.session.session import Session
from culet.engine.session.snapshot import SessionSnapshot
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.frame import Flags, Frame
from culet_protocol.messages import Balance
from engine.peer import PATIENCE, EngineProcess, Watcher, connected

FINE = {"optics": {"bands": 4, "polarised": True, "cutoff": 0.005}, "stones": [{"position": [0, 500, 0]}]}
"""More than any moving frame gets, unless the balance is pinned to that; falling for ten seconds."""
SIZE = {"width": 800, "height": 450}


def moving(frame: Frame) -> bool:
    return Flags.MOVING in frame.flags


def error_of(frame: Frame) -> float:
    """Measured for how the frame itself was drawn."""
    return ERRORS.radiance(frame.width / SIZE["width"], round(frame.cutoff, 6), frame.max_bounces)


async def moving_frame(watcher: Watcher, cutoff: float) -> Frame:
    """The first moving frame with that cut-off; TimeoutError if none comes among those that do."""
    async with asyncio.timeout(PATIENCE):
        return await watcher.until(lambda frame: moving(frame) and math.isclose(frame.cutoff, cutoff, rel_tol=1e-6))


async def test_a_moving_frame_says_what_the_governor_chose_and_whose_error_it_gives(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(FINE))
        await peer.demand(**SIZE)
        await peer.control("toggle_fall")
        frame = await watcher.until(moving)
        assert (frame.bands, frame.samples) == (3, 1)
        assert frame.max_bounces in {rung.max_bounces for rung in read_ladder()}
        assert frame.cutoff >= 0.01 - 1e-6
        assert Flags.POLARISED not in frame.flags
        assert Flags.FRONTIER in frame.flags
        assert math.isclose(frame.error, error_of(frame), rel_tol=1e-6)
        await peer.control("toggle_fall")
        still = await watcher.until(lambda frame: Flags.FINAL in frame.flags)
        assert (still.bands, still.width, still.height) == (4, SIZE["width"], SIZE["height"])
        assert math.isclose(still.cutoff, 0.005, rel_tol=1e-6)
        assert Flags.POLARISED in still.flags
        assert Flags.FRONTIER not in still.flags
        assert still.error > 0


async def test_a_pinned_balance_draws_every_moving_frame_that_well(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(FINE))
        await peer.demand(**SIZE)
        await peer.control("balance", exactness=1, pinned=True)
        await peer.control("toggle_fall")
        exact = await moving_frame(watcher, 0.005)
        assert (exact.width, exact.height, exact.bands) == (SIZE["width"], SIZE["height"], 4)
        assert Flags.POLARISED in exact.flags
        assert Flags.FRONTIER not in exact.flags
        assert math.isnan(exact.error), "never measured, and a single sample"
        await peer.control("balance", exactness=0, pinned=True)
        fast = await moving_frame(watcher, read_ladder()[-1].cutoff)
        assert (fast.width, fast.height, fast.bands) == (640, 360, 3)
        assert math.isclose(fast.error, error_of(fast), rel_tol=1e-6)
        assert math.isclose(fast.error, 0.0518, rel_tol=1e-6), "of 0.8 of the size, 16 reflections"


async def test_the_gateway_is_told_of_a_changed_balance(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        await peer.open()
        assert (await peer.result(type="get_session", session=peer.session))["exactness"] == 0.5
        await peer.control("balance", exactness=0.25, pinned=True)
        state = await peer.told(lambda told: told.get("session") == peer.session and told.get("pinned", False))
        assert state["exactness"] == 0.25
        described = await peer.result(type="get_session", session=peer.session)
        assert (described["exactness"], described["pinned"]) == (0.25, True)


@pytest.mark.parametrize("exactness", [-0.1, 1.5])
async def test_a_balance_out_of_range_is_refused_by_name(engine: EngineProcess, exactness: float) -> None:
    async with connected(engine) as (peer, _):
        await peer.open()
        reply = await peer.control("balance", exactness=exactness, pinned=False)
        assert reply["status"] == 422
        assert "exactness" in reply["detail"]
        assert f"got {exactness:g}" in reply["detail"]
        assert (await peer.result(type="get_session", session=peer.session))["exactness"] == 0.5


def test_another_engine_goes_on_with_the_balance() -> None:
    scene = Scene()
    session = Session("0" * 32, Stage.of(scene))
    session.balance = Balance(exactness=0.75, pinned=True)
    snapshot = SessionSnapshot.read(json.loads(session.snapshot().model_dump_json()))
    assert Session.restored("0" * 32, session.stage, snapshot).balance == session.balance
