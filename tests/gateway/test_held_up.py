"""A gateway whose loop stands still while frames keep coming lives on, and its streams with it."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path

import httpx
import pytest
from websockets.asyncio.client import connect

from culet_protocol.messages import ToggleFall
from gateway.running import PATIENCE, SIZE, Endpoints, Viewer, announced

FALLING = {"stones": [{"position": [0, 50_000, 0]}], "simulation": {"gravity": 1}}
"""A stone that falls for as long as the test takes, so that there are always frames."""


@pytest.mark.parametrize(
    ("times", "seconds"), [(1, 5.0), pytest.param(10, 8.0, marks=pytest.mark.soak)], ids=["once", "ten-times"]
)
async def test_a_loop_held_up_while_frames_come_ends_neither_the_gateway_nor_its_streams(
    engine: Endpoints, times: int, seconds: float
) -> None:
    """With ZeroMQ's heartbeats on the socket of frames, 30 of 30 processes were aborted after 5, 8 and 12 s."""
    command = [sys.executable, str(Path(__file__).with_name("held_gateway.py")), *engine]
    gateway = subprocess.Popen(  # noqa: ASYNC220 - it returns at once
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert gateway.stdin
    assert gateway.stdout
    try:
        url = await asyncio.to_thread(announced, gateway)
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            session = (await http.post("/api/sessions", json={"scene": FALLING})).json()["id"]
            stream = url.replace("http", "ws", 1) + f"api/sessions/{session}/stream"
            async with connect(stream, max_size=None, ping_interval=None) as websocket:
                viewer = Viewer(websocket)
                await viewer.say(SIZE)
                await viewer.say(ToggleFall())

                async def more_frames() -> None:
                    count = len(viewer.frames)
                    await viewer.until(lambda: len(viewer.frames) > count + 30)

                for _ in range(times):
                    await more_frames()
                    gateway.stdin.write(f"{seconds}\n")
                    gateway.stdin.flush()
                    assert await asyncio.to_thread(gateway.stdout.readline) == f"held up for {seconds:g} s\n"
                    await more_frames()
                    assert gateway.poll() is None
            await http.delete(f"/api/sessions/{session}")
    finally:
        gateway.terminate()
        try:
            gateway.communicate(timeout=PATIENCE)
        finally:
            gateway.kill()
            gateway.wait()
    assert gateway.returncode == 0
