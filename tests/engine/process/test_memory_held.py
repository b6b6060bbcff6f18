"""An engine of 256 MiB: whatever skies sessions upload and show, it stays within that, and says what it forgot."""

from __future__ import annotations

import os
import re
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import trimesh

from culet_protocol.frame import Flags
from engine.peer import EngineProcess, Peer, connected, running_engine
from optics.sky_files.writers import chunk

BUDGET = 2**28
WIDTH = 2800
SKY_BYTES = 12 * WIDTH * WIDTH // 2
"""45 MiB of a sky as it is kept: four leave 8 MiB more than the 64 MiB that reading a file may take."""


@pytest.fixture(scope="module")
def small_engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EngineProcess]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CULET_MEMORY", str(BUDGET))
        with running_engine(tmp_path_factory.mktemp("e")) as engine:
            yield engine


def grey(level: int, width: int = WIDTH) -> bytes:
    """A PNG of some kilobytes."""
    head = struct.pack(">IIBBBBB", width, width // 2, 8, 0, 0, 0, 0)
    pixels = zlib.compress((b"\0" + bytes([level]) * width) * (width // 2), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


def scene(sky: str) -> dict[str, Any]:
    return {"stones": [], "floor": {"kind": "none"}, "environment": {"kind": "image", "image": sky}}


async def put(peer: Peer, name: str, level: int) -> dict[str, Any]:
    return await peer.ask(grey(level), type="put_sky", file_type="png", sky=name)


async def held(peer: Peer) -> int:
    status = await peer.status()
    return sum(
        size
        for name, size in status.items()
        if name.startswith("memory_") and name.endswith("_bytes") and name != "memory_budget_bytes"
    )


def resident(engine: EngineProcess) -> int:
    """Bytes of memory that the process has, as the system counts them."""
    statm = Path(f"/proc/{engine.process.pid}/statm").read_text(encoding="ascii")
    return int(statm.split()[1]) * os.sysconf("SC_PAGE_SIZE")


async def test_one_session_that_shows_ever_other_skies_levels_off(small_engine: EngineProcess) -> None:
    async with connected(small_engine) as (peer, watch):
        watcher = watch(await peer.open({"stones": []}))
        await peer.demand()
        first = (await watcher.next()).step
        before = resident(small_engine)
        steps = []
        for number in range(7):  # 314 MiB, if all were kept
            assert (await put(peer, f"sky-{number}", 10 * number + 20))["status"] == 200
            assert (await peer.control("set_scene", scene=scene(f"sky-{number}")))["status"] == 200
            step = (await peer.status_of_session())["step"]
            await watcher.until(lambda frame, step=step: frame.step >= step)  # type: ignore[misc]
            steps.append(step)
            assert await held(peer) <= BUDGET
        assert resident(small_engine) - before < BUDGET
        status = await peer.status()
        assert 2 <= status["skies"] < 7
        assert status["memory_skies_bytes"] == status["skies"] * SKY_BYTES
        assert status["memory_budget_bytes"] == BUDGET

        still: dict[str, Any] = {"type": "render", "session": peer.session, "width": 32, "height": 16, "samples": 1}
        assert (await peer.ask(**still, step=steps[-1]))["status"] == 200
        assert (await peer.ask(**still, step=steps[-2]))["status"] == 200
        gone = await peer.ask(**still, step=steps[0])
        assert gone["status"] == 404
        assert f"what was shown at step {steps[0]} is not kept any more" in gone["detail"]
        assert "'sky-0'" in gone["detail"]
        assert (await peer.ask(**still, step=first))["status"] == 200, "it showed no sky that could be gone"
        await peer.result(type="close_session", session=peer.session)


async def test_a_sky_that_is_shown_outlives_those_that_are_not(small_engine: EngineProcess) -> None:
    async with connected(small_engine) as (peer, watch):
        assert (await put(peer, "shown", 40))["status"] == 200
        watcher = watch(await peer.open(scene("shown")))
        await watcher.until(lambda frame: Flags.FINAL in frame.flags)
        for number in range(5):
            assert (await put(peer, f"other-{number}", 50 + number))["status"] == 200
        assert (await peer.control("patch_scene", patch={"environment": {"turn_degrees": 90}}))["status"] == 200
        reply = await peer.ask(type="render", scene=scene("shown"), width=32, height=16, samples=1)
        assert reply["status"] == 200, reply
        forgotten = await peer.ask(type="render", scene=scene("other-0"), width=32, height=16, samples=1)
        assert (forgotten["status"], forgotten["field"]) == (422, "environment.image")
        await peer.result(type="close_session", session=peer.session)


def ball(size: float) -> bytes:
    """5 120 triangles, no two in one plane: 1.2 MiB of a mesh as it is kept."""
    return bytes(trimesh.creation.icosphere(subdivisions=4, radius=size).export(file_type="stl"))


async def test_when_sessions_show_all_that_fits_the_next_upload_is_told_so(small_engine: EngineProcess) -> None:
    """Skies first; then stones, as many of 64 as can have a mesh each."""
    async with connected(small_engine) as (peer, _):

        async def stone(number: int) -> dict[str, Any]:
            """Bring one more, with a mesh of its own."""
            reply = await peer.ask(ball(1 + number), type="put_mesh", file_type="stl", mesh=f"ball-{number}")
            if reply["status"] == 200:
                patch = {"mesh": f"ball-{number}", "scale": 0.2, "position": [0.5 * number, 0, 0]}
                reply = await peer.control("patch_scene", patch={"stones": {f"stone-{number}": patch}})
            return reply

        sessions = []
        for number in range(8):
            reply = await put(peer, f"mine-{number}", 100 + number)
            if reply["status"] != 200:
                break
            sessions.append(await peer.open(scene(f"mine-{number}")))
        assert 2 <= len(sessions) < 7
        assert reply["status"] == 429
        assert "memory" in reply["detail"]
        assert await held(peer) <= BUDGET

        sessions.append(await peer.open({"stones": []}))
        made = 0
        while (reply := await stone(made))["status"] == 200:
            made += 1
            assert made < 64
        assert made >= 1
        assert reply["status"] == 429
        assert re.search(r"reading (a|the) mesh needs \d+ MiB of memory, .*\d+ MiB .*are free", reply["detail"])
        assert await held(peer) <= BUDGET
        shown = await peer.result(type="get_scene", session=peer.session)
        assert [each["mesh"] for each in shown["scene"]["stones"]] == [f"ball-{number}" for number in range(made)]
        assert (await peer.control("patch_scene", patch={"camera": {"fov_degrees": 50}}))["status"] == 200

        await peer.result(type="close_session", session=sessions.pop(0))
        assert (await stone(made))["status"] == 200, "there is room again, since nobody shows that sky"
        for session in sessions:
            await peer.result(type="close_session", session=session)
        assert (await put(peer, "after", 99))["status"] == 200


async def test_the_same_file_again_is_not_kept_twice(small_engine: EngineProcess) -> None:
    async with connected(small_engine) as (peer, _):
        described = [await put(peer, "twice", 77) for _ in range(2)]
        assert described[0] == described[1]
        await peer.open(scene("twice"))
        before = await held(peer)
        await put(peer, "twice", 77)
        assert await held(peer) == before
        await peer.result(type="close_session", session=peer.session)


async def test_a_still_that_cannot_fit_is_refused_by_its_memory(small_engine: EngineProcess) -> None:
    """8192 x 4096 pixels are summed in 1 GiB."""
    async with connected(small_engine) as (peer, _):
        reply = await peer.ask(type="render", scene={"stones": []}, width=8192, height=4096)
        assert reply["status"] == 429
        assert "a still of 8192 x 4096 needs 1120 MiB of memory" in reply["detail"]


async def test_a_live_picture_is_no_larger_than_memory_allows(small_engine: EngineProcess) -> None:
    async with connected(small_engine) as (peer, _):
        sizes = []
        for _ in range(8):
            session = await peer.open({"stones": []})
            large: dict[str, Any] = {"width": 2560, "height": 1440}
            sizes.append(await peer.result(type="demand", session=session, frames_per_second=30, **large))
        pixels = [size["width"] * size["height"] for size in sizes]
        assert pixels[0] > 1_000_000
        assert pixels == sorted(pixels, reverse=True)
        assert 35 * sum(pixels) < BUDGET
        for size in sizes[:4]:
            assert size["width"] / size["height"] == pytest.approx(16 / 9, rel=0.02)
