"""What must be had from running containers: a page, a picture, a streamed frame. `make compose-test` calls this.

python tests/docker/check_stack.py 127.0.0.1:8000 [--after-restart]
"""

from __future__ import annotations

import argparse
import asyncio
import io
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import httpx
from PIL import Image
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Ack, Resize, ToggleFall

PATIENCE = 60.0
"""Seconds for each answer: the first picture waits for the compiler."""
TGA_FOOTER = b"TRUEVISION-XFILE.\0"


def check(holds: bool, claim: str) -> None:
    """Print the claim, or end with it."""
    if not holds:
        raise SystemExit(f"not true: {claim}")
    print(f"  {claim}")


async def until(claim: str, condition: Callable[[], Awaitable[bool]]) -> None:
    """Wait for the claim to come true, or end with it."""
    began = time.monotonic()
    while not await condition():
        if time.monotonic() - began > PATIENCE:
            raise SystemExit(f"not true within {PATIENCE:g} s: {claim}")
        await asyncio.sleep(0.2)
    check(True, f"{claim} after {time.monotonic() - began:.1f} s")


async def engine_processes(http: httpx.AsyncClient) -> int:
    """How many engine processes the gateway has seen."""
    name = "culet_engine_processes_total"
    text = (await http.get("/metrics")).text
    return next(int(float(line.split()[1])) for line in text.splitlines() if line.startswith(name))


@asynccontextmanager
async def viewer(address: str, session: str) -> AsyncIterator[ClientConnection]:
    """A viewer's WebSocket."""
    url = f"ws://{address}/api/sessions/{session}/stream"
    async with connect(url, subprotocols=[Subprotocol(SUBPROTOCOL)], max_size=None, compression=None) as socket:
        await socket.send(Resize(width=320, height=180).model_dump_json())
        yield socket


async def next_frame(socket: ClientConnection) -> Frame:
    """The next binary message, acknowledged, since a viewer gets no more than a few frames ahead of that."""
    async with asyncio.timeout(PATIENCE):
        while True:
            message = await socket.recv()
            if isinstance(message, bytes):
                frame = Frame.unpack(message)
                await socket.send(Ack(sequence=frame.sequence).model_dump_json())
                return frame


async def main() -> None:
    """Ask for everything once."""
    parser = argparse.ArgumentParser()
    parser.add_argument("address", help="host:port of the gateway")
    parser.add_argument("--after-restart", action="store_true", help="wait for a second engine process first")
    arguments = parser.parse_args()
    address: str = arguments.address
    async with httpx.AsyncClient(base_url=f"http://{address}", timeout=PATIENCE) as http:

        async def restarted() -> bool:
            return await engine_processes(http) >= 2

        async def ready() -> bool:
            return (await http.get("/readyz")).status_code == 200

        if arguments.after_restart:
            await until("the gateway has met a second engine process", restarted)
        await until("the gateway is ready", ready)

        page = await http.get("/")
        check(page.status_code == 200 and "<canvas" in page.text, "the page is served")

        picture = (await http.get("/api/render.tga", params={"width": 320, "height": 180})).raise_for_status().content
        with Image.open(io.BytesIO(picture)) as image:
            colours = image.getcolors(320 * 180) or []
            check(image.size == (320, 180), "a TGA of the size asked for comes")
        check(picture.endswith(TGA_FOOTER), "it ends with the footer of TGA 2.0")
        check(len(colours) > 1000, f"it shows something: {len(colours)} colours")

        session = (await http.post("/api/sessions", json={})).raise_for_status().json()["id"]
        async with viewer(address, session) as socket:
            first = await next_frame(socket)
            check(first.session.hex() == session, f"a streamed frame comes: {first.width} x {first.height}")
            await socket.send(ToggleFall().model_dump_json())
            last = first
            for _ in range(20):
                last = await next_frame(socket)
            check(
                last.simulation_time > 0,
                f"the stone falls: frame {last.sequence} shows t = {last.simulation_time:.2f} s",
            )
        (await http.delete(f"/api/sessions/{session}")).raise_for_status()


if __name__ == "__main__":
    asyncio.run(main())
