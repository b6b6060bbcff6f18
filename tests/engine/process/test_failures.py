"""The real engine over sockets, in this process, with a renderer that fails for one kind of scene."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
import zmq.asyncio

from culet.engine.capacity.limits import Limits
from culet.engine.painting.renderer import AnyPicture
from culet.engine.process.engine import EngineServer
from culet.engine.process.serve import encode_still
from culet.engine.session import events
from culet.engine.session.session import Session
from culet.errors import DeviceError
from culet.optics.panoramas import Panorama
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import Renderer
from culet.simulation.one_stone.models import MODELS
from culet.simulation.rigid_body.state import RigidState
from culet.stage import Library, Stage
from culet_protocol.frame import Flags
from culet_protocol.messages import SessionEvent
from culet_protocol.watch import watch_id
from engine.peer import Peer, Watcher, watching

REFUSED: dict[str, Any] = {"environment": {"kind": "half"}}
GOOD: dict[str, Any] = {"environment": {"kind": "dark"}, "floor": {"kind": "none"}}


class FailingRenderer:
    """The OpenCL renderer, but for scenes with a half-lit sky, whose kernels do not build."""

    def __init__(self) -> None:
        self.renderer = Renderer()

    def picture(
        self, stage: Stage, width: int, height: int, *, effort: LightEffort = LightEffort.PATIENT
    ) -> AnyPicture:
        if stage.scene.environment.kind == "half":
            raise DeviceError("the kernel does not build")
        return self.renderer.picture(stage, width, height, effort=effort)

    cut_out = picture

    def is_ready(self, stage: Stage, samples: int = 0) -> bool:
        return self.renderer.is_ready(stage, samples)

    def make_ready(self, stage: Stage, samples: int = 0) -> None:
        self.renderer.make_ready(stage, samples)

    def describe(self) -> Mapping[str, Any]:
        return self.renderer.describe()

    def forget(self, panorama: Panorama) -> None:
        self.renderer.forget(panorama)

    def held(self) -> Mapping[str, int]:
        return self.renderer.held()

    def release(self) -> None:
        self.renderer.release()

    def trim(self) -> None:
        self.renderer.trim()


@asynccontextmanager
async def served(folder: Path) -> AsyncIterator[tuple[Peer, Callable[[str], Watcher]]]:
    """An engine in this process; a peer of it, and what watches a session."""
    control, frames = f"ipc://{folder}/control", f"ipc://{folder}/frames"
    context, stopping, thread = zmq.asyncio.Context(), asyncio.Event(), ThreadPoolExecutor(1)
    engine = EngineServer(context, control, [frames], Limits(), FailingRenderer(), thread, encode_still)
    running = asyncio.create_task(engine.run_until(stopping))
    peer = Peer(context, control)
    try:
        with watching(context, frames) as watch:
            yield peer, watch
    finally:
        stopping.set()
        await running
        peer.reader.cancel()
        thread.shutdown()
        context.destroy(linger=0)


async def test_a_scene_that_cannot_be_rendered_is_a_problem_of_its_session_alone(tmp_path: Path) -> None:
    async with served(tmp_path) as (peer, watch):
        good = watch(await peer.open(GOOD))
        bad = watch(await peer.open(REFUSED))
        problem = await peer.told(lambda told: told["type"] == "session_problem")
        assert (problem["session"], problem["detail"]) == (peer.session, "the kernel does not build")

        await good.until(lambda frame: Flags.FINAL in frame.flags)
        status = await peer.status()
        assert status["problems"] == 1  # not tried again and again

        reply = await peer.ask(type="render", scene=REFUSED, width=16, height=16, samples=1)
        assert (reply["status"], reply["detail"]) == (500, "the kernel does not build")

        assert (await peer.control("set_scene", scene=GOOD))["status"] == 200
        assert (await bad.next()).watch.hex() == watch_id(peer.session)  # an edit that helps


async def test_a_stone_that_cannot_be_simulated_is_a_problem_of_its_session_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> RigidState:
        raise ZeroDivisionError("0 / 0")

    monkeypatch.setitem(MODELS, "classic", MODELS["classic"]._replace(step=fail))
    async with served(tmp_path) as (peer, watch):
        falling = watch(await peer.open({"simulation": {"model": "classic"}} | GOOD))
        await peer.demand()
        await falling.next()
        assert (await peer.control("toggle_fall"))["result"]["falling"]
        problem = await peer.told(lambda told: told["type"] == "session_problem")
        assert (problem["session"], problem["detail"]) == (peer.session, "simulating failed: ZeroDivisionError: 0 / 0")
        state = await peer.told(lambda told: told["type"] == "session_change" and not told["falling"])
        assert state["session"] == peer.session
        # Another engine does not run into it again. What news of the motion has told before is not told twice.
        assert not state["moved"].get("falling", state["falling"])

        await falling.until(lambda frame: Flags.FINAL in frame.flags)  # it is still shown
        other = watch(await peer.open(GOOD))
        await other.until(lambda frame: Flags.FINAL in frame.flags)
        assert (await peer.status())["problems"] == 1


@pytest.mark.parametrize("event", ["toggle_fall", "reset_stone", "toggle_walls", "push", "patch_scene", "set_scene"])
async def test_what_may_take_long_does_not_run_where_all_sessions_are_served(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, event: str
) -> None:
    values: dict[str, dict[str, Any]] = {
        "push": {"x": 0, "y": 0, "right": 0, "up": 0.1},
        "patch_scene": {"patch": {}},
        "set_scene": {"scene": GOOD},
    }
    threads = []
    apply = events.apply

    def noted(session: Session, event: SessionEvent, library: Library) -> None:
        threads.append(threading.current_thread())
        apply(session, event, library)

    monkeypatch.setattr(events, "apply", noted)
    async with served(tmp_path) as (peer, _):
        await peer.open(GOOD)
        assert (await peer.control(event, **values.get(event, {})))["status"] == 200
    assert len(threads) == 1
    assert threads[0] is not threading.main_thread()
