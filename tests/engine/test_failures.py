"""The real engine over sockets, in this process, with a renderer that fails for one kind of scene."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import zmq.asyncio

from culet.engine.drawing import Picture
from culet.engine.limits import Limits
from culet.engine.serve import Engine, encode_still
from culet.errors import DeviceError
from culet.geometry.stone import Stone
from culet.rendering.panoramas import Panorama
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet_protocol.frame import Flags
from engine.peer import Peer, Watcher

REFUSED: dict[str, Any] = {"environment": {"kind": "half"}}
GOOD: dict[str, Any] = {"environment": {"kind": "dark"}, "floor": {"kind": "none"}, "lights": []}


class FailingRenderer:
    """The OpenCL renderer, but for scenes with a half-lit sky, whose kernels do not build."""

    def __init__(self) -> None:
        self.renderer = Renderer()

    def picture(
        self, scene: Scene, stone: Stone | None, width: int, height: int, *, panorama: Panorama | None = None
    ) -> Picture:
        if scene.environment.kind == "half":
            raise DeviceError("the kernel does not build")
        return self.renderer.picture(scene, stone, width, height, panorama=panorama)

    def describe(self) -> Mapping[str, Any]:
        return self.renderer.describe()


async def test_a_scene_that_cannot_be_rendered_is_a_problem_of_its_session_alone(tmp_path: Path) -> None:
    control, frames = f"ipc://{tmp_path}/control", f"ipc://{tmp_path}/frames"
    context, stopping, thread = zmq.asyncio.Context(), asyncio.Event(), ThreadPoolExecutor(1)
    engine = Engine(context, control, [frames], Limits(), FailingRenderer(), thread, encode_still)
    running = asyncio.create_task(engine.run_until(stopping))
    peer = Peer(context, control)
    try:
        good = Watcher(context, frames, await peer.open(GOOD))
        bad = Watcher(context, frames, await peer.open(REFUSED))
        problem = await peer.told(lambda told: told["type"] == "session_problem")
        assert (problem["session"], problem["detail"]) == (peer.session, "the kernel does not build")

        await good.until(lambda frame: Flags.FINAL in frame.flags)
        status = await peer.status()
        assert status["problems"] == 1  # not tried again and again

        reply = await peer.ask(type="render", scene=REFUSED, width=16, height=16)
        assert (reply["status"], reply["detail"]) == (500, "the kernel does not build")

        assert (await peer.control("set_scene", scene=GOOD))["status"] == 200
        assert (await bad.next()).session.hex() == peer.session  # an edit that helps
    finally:
        stopping.set()
        await running
        peer.reader.cancel()
        thread.shutdown()
        context.destroy(linger=0)
