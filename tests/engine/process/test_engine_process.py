"""The real engine process, spoken to over its sockets."""

from __future__ import annotations

import asyncio
import io
import itertools
import math
import os
import subprocess
import sys
import time
from itertools import count, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq
from PIL import Image

from culet_client import RefusedError, connect
from culet_protocol.engine import REQUEST_NUMBER
from culet_protocol.frame import Flags
from culet_protocol.messages import PatchScene, ToggleFall
from culet_protocol.watch import VIDEO, watch_id
from engine.peer import PATIENCE, SIZE, EngineProcess, connected, running_engine

UNKNOWN = "f" * 32
PLAIN: dict[str, Any] = {
    "environment": {"kind": "dark"},
    "floor": {"kind": "none"},
    "emitters": [],
    "optics": {"max_bounces": 4},
}
"""A scene that takes next to no time."""


def pixels(data: bytes) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float)


def difference(one: bytes, other: bytes) -> float:
    """Mean over the pixels, of 255."""
    return float(np.abs(pixels(one) - pixels(other)).mean())


async def test_a_picture_at_rest_is_refined_to_its_end_and_then_costs_nothing(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN))
        await peer.demand()
        frames = [await watcher.until(lambda frame: frame.width == SIZE["width"])]
        while Flags.FINAL not in frames[-1].flags:
            frames.append(await watcher.next())
        # Each frame sent has more samples, at most twice as many; a subscriber that is slow for a moment misses some.
        assert frames[-1].samples == 16
        for earlier, later in pairwise(frames):
            assert earlier.samples < later.samples <= earlier.samples * 2 ** (later.sequence - earlier.sequence)
        assert len({frame.step for frame in frames}) == 1
        for frame in frames:
            assert math.isnan(frame.error) if frame.samples == 1 else 0 < frame.error < 1  # of one nothing is known
            assert math.isnan(frame.shown_error) if frame.samples == 1 else 0 < frame.shown_error < 1
            assert math.isnan(frame.rest_error) if frame.samples == 1 else frame.rest_error == np.float32(0.004)
        assert len(frames) == len({frame.sequence for frame in frames}) > 1
        before = await peer.status()
        repeated = await watcher.next()  # a second later, since it could have been lost
        assert (repeated.sequence, repeated.payload) == (frames[-1].sequence, frames[-1].payload)
        after = await peer.status()
        assert (after["frames_rendered"], after["refinements"]) == (before["frames_rendered"], before["refinements"])
        await peer.result(type="close_session", session=peer.session)


async def test_frames_say_where_a_stone_is_that_they_do_not_show_until_the_camera_looks_at_it(
    engine: EngineProcess,
) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN | {"stones": [{"position": [8, 1, 0]}]}))
        await peer.demand()
        frame = await watcher.until(lambda frame: frame.width == SIZE["width"])
        assert Flags.RIGHT in frame.flags
        await peer.demand(width=300, height=16)  # so wide that it is in the picture
        frame = await watcher.until(lambda frame: frame.width == 300)
        assert Flags.RIGHT not in frame.flags
        await peer.demand()
        before = await watcher.until(lambda frame: Flags.RIGHT in frame.flags and Flags.FINAL in frame.flags)
        assert (await peer.control("look_at_stone"))["status"] == 200
        frame = await watcher.until(lambda frame: frame.step > before.step)
        assert frame.flags & (Flags.ABOVE | Flags.BELOW | Flags.LEFT | Flags.RIGHT | Flags.BEHIND) == 0
        await peer.control("set_scene", scene=PLAIN | {"stones": []})
        step = frame.step
        frame = await watcher.until(lambda frame: frame.step > step)
        assert frame.flags & (Flags.ABOVE | Flags.BELOW | Flags.LEFT | Flags.RIGHT | Flags.BEHIND) == 0
        await peer.result(type="close_session", session=peer.session)


async def test_a_frame_says_what_it_shows(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN))
        await peer.demand()
        frame = await watcher.until(lambda frame: frame.width == SIZE["width"])
        assert frame.watch.hex() == watch_id(peer.session)
        assert frame.codec not in VIDEO
        assert pixels(frame.payload).shape == (SIZE["height"], SIZE["width"], 3)
        assert abs(frame.timestamp - time.time()) < 60
        assert min(frame.render_ms, frame.encode_ms) > 0
        assert 0 <= frame.cut < 1


async def test_nobody_watching_nothing_is_rendered(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN))
        await peer.demand()
        await peer.control("toggle_fall")
        await watcher.until(lambda frame: Flags.MOVING in frame.flags)
        assert (await peer.status())["sessions_moving"] >= 1
        watcher.leave()
        await peer.demand(frames_per_second=0)
        while (await peer.status())["sessions_watched"]:
            pass  # the status request itself waits for the engine
        before = (await peer.status())["frames_rendered"]
        beats = len(peer.unasked)
        while len(peer.unasked) < beats + 2:  # two heartbeats: at least a second, 60 frames if it went on
            await peer.status()
        after = await peer.status()
        assert after["sessions_moving"] == 0  # for nobody
        assert after["frames_rendered"] - before <= 1  # the one under way


async def test_who_subscribes_late_gets_the_latest_frame_at_once(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        first = watch(await peer.open(PLAIN))
        await peer.demand()
        final = await first.until(lambda frame: Flags.FINAL in frame.flags and frame.width == SIZE["width"])
        assert (await watch(peer.session).next()).sequence == final.sequence


async def test_a_native_viewer_needs_no_gateway_to_be_shown_frames(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        frame = await watch(await peer.open(PLAIN)).next()
        assert (frame.width, frame.height) == (960, 540)


async def test_a_falling_stone_moves_from_frame_to_frame_in_order(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN | {"stones": [{"position": [0, 500, 0]}]}))
        await peer.demand()
        await peer.control("toggle_fall")
        frames = [await watcher.until(lambda frame: Flags.MOVING in frame.flags)]
        while len(frames) < 10:
            frames.append(await watcher.next())
        for before, after in itertools.pairwise(frames):
            assert after.sequence > before.sequence
            assert after.step > before.step
            assert after.simulation_time > before.simulation_time
        motion = await peer.told(
            lambda told: (
                told["type"] == "session_motion"
                and told["session"] == peer.session
                and told["moved"].get("step", 0) >= frames[-1].step
                and "simulation" in told["moved"]  # a busy machine may have taken no step since it was told last
            )
        )
        assert "falling" not in motion["moved"], "which was told with the event"
        assert motion["moved"]["simulation"]["time"] >= frames[-1].simulation_time


async def test_no_more_frames_are_made_than_are_asked_for(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN))
        await peer.demand(frames_per_second=5)
        await peer.control("toggle_fall")
        first = await watcher.until(lambda frame: Flags.MOVING in frame.flags)
        last = first
        for _ in range(5):
            last = await watcher.next()
        assert last.timestamp - first.timestamp > 0.5  # five intervals of 0.2 s; the first may be late by nearly one


async def test_a_frame_can_be_had_again_as_a_still_of_its_step(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open({"floor": {"kind": "matte"}}))
        await peer.demand()
        final = await watcher.until(lambda frame: Flags.FINAL in frame.flags)
        await peer.control("orbit", yaw=0.5, pitch=0.2)
        now = await watcher.until(lambda frame: Flags.FINAL in frame.flags and frame.step > final.step)
        for shown, other, step in ((final, now, final.step), (now, final, now.step), (now, final, None)):
            reply, data = await peer.ask_later(type="render", session=peer.session, step=step, format="png", **SIZE)
            error = reply["result"].pop("error")
            assert 0 < error < 1
            assert reply["result"] == SIZE | {"samples": 16, "met": error <= 0.004, "step": shown.step, "format": "png"}
            assert data is not None
            assert difference(data, shown.payload) < 0.01, "without loss"
            assert difference(data, other.payload) > 12  # measured 25.7


async def test_a_step_that_was_never_shown_is_not_found(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        await peer.open(PLAIN)
        reply = await peer.ask(type="render", session=peer.session, step=10**9)
        assert reply["status"] == 404
        assert "never shown or is forgotten" in reply["detail"]


async def test_a_still_of_a_scene_is_what_was_asked_for(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        reply, data = await peer.ask_later(type="render", scene=PLAIN, width=33, height=17, samples=1, format="tga")
        quality = {"samples": 1, "error": None, "met": None}
        assert reply["result"] == {"width": 33, "height": 17, "step": None, "format": "tga", **quality}
        assert data is not None
        assert pixels(data).shape == (17, 33, 3)


@pytest.mark.parametrize("of", ["scene", "session"])
async def test_a_still_says_whether_it_has_the_error_that_was_asked_for(engine: EngineProcess, of: str) -> None:
    """Measured 0.0047 of ten samples."""
    async with connected(engine) as (peer, _):
        whose = {"scene": PLAIN} if of == "scene" else {"session": await peer.open(PLAIN)}
        asked = {"type": "render", **whose, **SIZE}
        met = (await peer.ask(**asked, error=0.005))["result"]
        missed = (await peer.ask(**asked, error=0.005, samples=met["samples"] - 1))["result"]
    assert (met["met"], missed["met"], missed["samples"]) == (True, False, met["samples"] - 1)
    assert 0 < met["error"] <= 0.005 < missed["error"] < 0.007


@pytest.mark.parametrize(("name", "value"), [("error", 0), ("error", 2), ("samples", 0), ("samples", 70000)])
async def test_a_still_that_no_picture_can_be_is_refused(engine: EngineProcess, name: str, value: float) -> None:
    async with connected(engine) as (peer, _):
        asked: dict[str, Any] = {"type": "render", "scene": PLAIN, **SIZE, name: value}
        reply = await peer.ask(**asked)
        assert (reply["status"], reply["field"]) == (422, name)


@pytest.mark.parametrize(
    ("request_", "status", "field"),
    [
        ({"type": "get_session", "session": UNKNOWN}, 404, None),
        ({"type": "close_session", "session": UNKNOWN}, 404, None),
        ({"type": "control", "session": UNKNOWN, "event": {"type": "reset_stone"}}, 404, None),
        ({"type": "render", "session": UNKNOWN}, 404, None),
        ({"type": "get_session", "session": "../x"}, 422, "get_session.session"),
        ({"type": "dance"}, 422, None),
        ({"type": "render"}, 422, "scene"),
        ({"type": "render", "scene": {}, "width": 0}, 422, "width"),
        ({"type": "render", "scene": {}, "height": 100_000}, 422, "height"),
        ({"type": "render", "scene": {}, "width": 8192, "height": 8192}, 422, "width"),
        ({"type": "render", "scene": {"camera": {"fov_degrees": float("nan")}}}, 422, "camera.fov_degrees"),
        ({"type": "render", "scene": {"stones": [{"mesh": "/etc/passwd"}]}}, 422, "stones.0.mesh"),
        ({"type": "open_session", "session": UNKNOWN, "scene": {"lamp": 1}}, 422, "lamp"),
        ({"type": "render", "scene": {"environment": {"kind": "image", "image": "none"}}}, 422, "environment.image"),
        ({"type": "put_mesh", "file_type": "obj", "mesh": "a"}, 422, None),
        ({"type": "put_sky", "file_type": "hdr", "sky": "a"}, 422, None),
    ],
)
async def test_bad_requests_get_a_reply_that_says_why(
    engine: EngineProcess, request_: dict[str, Any], status: int, field: str | None
) -> None:
    async with connected(engine) as (peer, _):
        reply = await peer.ask(**request_)
        assert reply["status"] == status, reply
        assert reply["detail"]
        if field:
            assert reply["field"] == field


async def test_what_is_no_request_at_all_is_answered_and_survived(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        await peer.told(lambda told: told["type"] == "heartbeat")
        number = REQUEST_NUMBER.pack(2**63)
        for parts in ([b"x"], [number, b"{", b"", b""], [number, b"{"], [number, b"\xff\xfe"], [number, b"[1]"]):
            peer.unasked.clear()
            await peer.raw(*parts)
            reply = await peer.told(lambda told: told["type"] == "reply")
            assert reply["status"] == 422
        assert (await peer.status())["instance"]


async def test_a_bad_event_leaves_the_session_as_it_was(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        await peer.open(PLAIN)
        before = await peer.result(type="get_session", session=peer.session)
        reply = await peer.control("patch_scene", patch={"floor": {"kind": "lava"}})
        assert (reply["status"], reply["field"]) == (422, "floor.kind")
        reply = await peer.control("orbit", yaw="much", pitch=0)
        assert (reply["status"], reply["field"]) == (422, "control.event.orbit.yaw")
        assert await peer.result(type="get_session", session=peer.session) == before


async def test_an_edit_is_told_to_every_gateway(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _), connected(engine) as (other, _):
        await other.told(lambda told: told["type"] == "heartbeat")
        await peer.open(PLAIN)
        await peer.control("toggle_environment")
        state = await other.told(lambda told: told["type"] == "session_change" and told["session"] == peer.session)
        assert state["edited"]
        assert state["parts"] == {"environment": {"kind": "light"}, "backdrop": {"kind": "none"}}


async def test_a_session_goes_on_in_another_engine(engine: EngineProcess, tmp_path: Path) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open({"stones": [{"position": [0, 400, 0]}]} | PLAIN))
        await peer.demand()
        await peer.control("toggle_fall")
        await watcher.until(lambda frame: frame.simulation_time > 0.1)
        await peer.control("toggle_fall")
        state = await peer.result(type="get_session", session=peer.session)
    with running_engine(tmp_path) as another:
        async with connected(another) as (peer, _):
            session: dict[str, Any] = {
                "session": state["session"],
                "scene": state["scene"],
                "snapshot": state["snapshot"],
            }
            restored = await peer.result(type="open_session", **session)
            assert restored["pose"] == state["pose"]
            assert restored["simulation_time"] == state["simulation_time"]
            assert restored["step"] > state["step"]
            again = await peer.result(type="open_session", **session)  # idempotent
            assert again["step"] == restored["step"]


async def test_a_gateway_that_comes_is_told_all_sessions(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        opened = [await peer.open(PLAIN, client=client) for client in ("192.0.2.7", None)]
        described = [await peer.result(type="get_session", session=session) for session in opened]
    async with connected(engine) as (peer, _):
        listed = {found["session"]: found for found in (await peer.result(type="list_sessions"))["sessions"]}
        assert [listed[session].pop("client") for session in opened] == ["192.0.2.7", None]
        assert [listed[session] for session in opened] == described
        for session in opened:
            await peer.result(type="close_session", session=session)


async def test_sessions_outlive_their_gateway(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        session = await peer.open(PLAIN)
    async with connected(engine) as (peer, _):
        assert (await peer.ask(type="get_session", session=session))["status"] == 200
        await peer.result(type="close_session", session=session)


async def test_but_not_for_ever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CULET_ORPHAN_SECONDS", "0.5")
    with running_engine(tmp_path) as engine:
        async with connected(engine) as (peer, _):
            session = await peer.open(PLAIN)
        async with asyncio.timeout(PATIENCE):
            for pause in count(1):  # a look is a gateway that comes, so looks get farther and farther between
                await asyncio.sleep(pause)
                async with connected(engine) as (peer, _):
                    if (await peer.ask(type="get_session", session=session))["status"] == 404:
                        break


async def test_those_who_only_connect_cannot_push_out_who_asks(engine: EngineProcess) -> None:
    """65 probes did, when all peers were one list."""
    async with connected(engine) as (peer, _):
        await peer.status()
        context = zmq.Context()
        probes = [context.socket(zmq.DEALER) for _ in range(200)]
        for probe in probes:
            probe.setsockopt(zmq.LINGER, 0)
            probe.setsockopt(zmq.PROBE_ROUTER, 1)
            probe.connect(engine.control)
        greeted = await asyncio.to_thread(lambda: [probe.poll(int(1000 * PATIENCE)) for probe in probes])
        assert all(greeted)
        context.destroy(linger=0)
        heard = len(peer.unasked)
        await peer.told(lambda told: told["type"] == "heartbeat" and any(told is new for new in peer.unasked[heard:]))


async def test_stills_beyond_the_limit_are_refused_and_the_others_done(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, _):
        still: dict[str, Any] = {
            "type": "render",
            "scene": {"sampling": {"samples_per_pixel": 16}},
            "width": 256,
            "height": 144,
        }
        endless = peer.ask_later(**still | {"samples": 2**15, "width": 1024, "height": 576})  # or one might be done
        number = peer.number
        waiting = [peer.ask_later(**still) for _ in range(11)]
        async with asyncio.timeout(PATIENCE):
            while sum(reply.done() for reply in waiting) < 4:
                await peer.status()
        assert (await peer.status())["stills_waiting"] == 8
        await peer.result(type="cancel", request=number)
        replies = await asyncio.gather(*waiting)
        assert not endless.done()
        statuses = sorted(reply["status"] for reply, _ in replies)
        assert statuses == [200] * 7 + [429] * 4
        assert all((data is not None) == (reply["status"] == 200) for reply, data in replies)


async def test_live_frames_go_on_while_a_still_is_rendered(engine: EngineProcess) -> None:
    async with connected(engine) as (peer, watch):
        watcher = watch(await peer.open(PLAIN | {"stones": [{"position": [0, 400, 0]}]}))
        await peer.demand()
        await peer.control("toggle_fall")
        await watcher.until(lambda frame: Flags.MOVING in frame.flags)
        before = (await peer.status())["frames_rendered"]
        still = await peer.ask(type="render", scene={"sampling": {"samples_per_pixel": 16}}, width=640, height=360)
        frames = (await peer.status())["frames_rendered"] - before
        assert still["status"] == 200
        assert frames >= 10  # measured 23 on a busy machine: one after every band


async def test_sessions_beyond_the_limit_are_refused(tmp_path: Path) -> None:
    with running_engine(tmp_path) as process:
        async with connected(process) as (peer, _):
            for _ in range(64):
                await peer.open(PLAIN)
            reply = await peer.ask(type="open_session", session=UNKNOWN, scene={})
            assert reply["status"] == 429
            await peer.result(type="close_session", session=peer.session)
            await peer.result(type="open_session", session=UNKNOWN, scene={})


async def test_sigterm_ends_the_engine_in_order_while_it_renders(tmp_path: Path) -> None:
    with running_engine(tmp_path) as process:
        async with connected(process) as (peer, watch):
            watcher = watch(await peer.open(PLAIN))
            await peer.control("toggle_fall")
            await watcher.next()
            process.process.terminate()
            assert await asyncio.to_thread(process.process.wait, PATIENCE) == 0


COMPILING = """
import sys, threading, time
from pathlib import Path
import pyopencl as cl
from culet.engine.process.serve import run
from culet.rendering.opencl.device import open_device

device = open_device()

def compile_for_ever():
    while not Path(sys.argv[2].removeprefix("ipc://")).exists():
        time.sleep(0.02)  # or the engine's own programs may wait for the driver's lock for ever
    number = 0
    while True:
        number += 1
        cl.Program(device.context, "__kernel void k(__global int *a) { a[0] = %d; }" % number).build()
        Path(sys.argv[3]).touch()

threading.Thread(target=compile_for_ever, daemon=True).start()
run(sys.argv[1], [sys.argv[2]])
"""


def test_sigterm_ends_the_engine_in_order_while_it_compiles(tmp_path: Path) -> None:
    control, frames, compiles = tmp_path / "control", tmp_path / "frames", tmp_path / "compiles"
    command = [sys.executable, "-c", COMPILING, f"ipc://{control}", f"ipc://{frames}", str(compiles)]
    compiler = {"PYOPENCL_NO_CACHE": "1", "POCL_CACHE_DIR": str(tmp_path)}
    engine = subprocess.Popen(command, env={**os.environ, **compiler})
    try:
        deadline = time.monotonic() + PATIENCE
        while not compiles.exists():
            assert time.monotonic() < deadline, "the engine did not begin"
            time.sleep(0.02)  # between two looks at another process
        engine.terminate()
        assert engine.wait(PATIENCE) == 0
    finally:
        engine.kill()
        engine.wait()


def test_a_viewer_needs_no_gateway_to_make_a_session_and_to_steer(engine: EngineProcess) -> None:
    scene = {"stones": [], "floor": {"kind": "none"}, "backdrop": {"kind": "none"}, "environment": {"kind": "light"}}
    with connect(
        engine.frames, control=engine.control, scene=scene, size=(64, 36), timeout_seconds=PATIENCE
    ) as connection:
        assert next(image for image in connection if image.pixels.shape == (36, 64, 3)).pixels.min() > 127
        connection.send(PatchScene(patch={"environment": {"kind": "dark"}}))
        assert next(image for image in connection if image.pixels.max() < 128).frame.sequence > 1
        with pytest.raises(RefusedError, match="lava"):
            connection.send(PatchScene(patch={"floor": {"kind": "lava"}}))
        session = connection.session
        assert session is not None
    with (
        connect(engine.frames, session=session, control=engine.control, timeout_seconds=PATIENCE) as late,
        pytest.raises(RefusedError, match="no such session"),
    ):
        late.send(ToggleFall())
