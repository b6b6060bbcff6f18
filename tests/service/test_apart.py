"""Engine and gateway started apart, as in containers, each with another one that stands by."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
from websockets.asyncio.client import connect

from gateway.running import PATIENCE, SIZE, TETRAHEDRON, Viewer, announced, eventually

OBJECT = {"file": ("stone.obj", TETRAHEDRON)}


@contextlib.contextmanager
def running(*words: str) -> Iterator[subprocess.Popen[str]]:
    """A command of culet's, told to stop at the end, which it does in order."""
    process = subprocess.Popen([sys.executable, "-m", "culet", *words], stdout=subprocess.PIPE, text=True)
    try:
        yield process
        process.terminate()
        process.communicate(timeout=PATIENCE)
        assert process.returncode == 0
    finally:
        process.kill()
        process.communicate()


def working(parent: subprocess.Popen[str]) -> int:
    """Process id of the one that works, which was started before the one that stands by; 0 if there is none."""
    children = Path(f"/proc/{parent.pid}/task/{parent.pid}/children").read_text().split()
    return int(children[0]) if children else 0


async def test_each_goes_on_by_the_one_that_stands_by_with_the_same_session_and_uploads(tmp_path: Path) -> None:
    endpoints = ("--control", f"ipc://{tmp_path}/control", "--frames", f"ipc://{tmp_path}/frames")
    with (
        running("engine", *endpoints, "--spare") as engine,
        running("gateway", *endpoints, "--spare", "--port", "0") as gateway,
    ):
        url = announced(gateway)
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            mesh = (await http.post("/api/meshes", files=OBJECT)).json()["id"]
            made = await http.post("/api/sessions", json={"scene": {"stones": [{"mesh": mesh}]}})
            session = made.json()["id"]

            async def described() -> dict[str, object] | None:
                with contextlib.suppress(httpx.TransportError):
                    answer = await http.get(f"/api/sessions/{session}")
                    return dict(answer.json()) if answer.status_code == 200 else None
                return None

            before = await described()
            assert before
            for parent in (gateway, engine):
                killed = working(parent)
                os.kill(killed, signal.SIGKILL)

                async def replaced(parent: subprocess.Popen[str] = parent, killed: int = killed) -> bool:
                    return working(parent) not in (0, killed) and await described() == before

                await eventually(replaced)
                assert parent.poll() is None
            stream = url.replace("http", "ws", 1) + f"api/sessions/{session}/stream"
            async with connect(stream, max_size=None) as websocket:
                viewer = Viewer(websocket)
                await viewer.say(SIZE)
                await viewer.frame()
