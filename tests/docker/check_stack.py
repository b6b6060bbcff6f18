"""What must be had from running containers, also after what can happen to them. `make compose-test` calls this.

PYTHONPATH=tests python -m docker.check_stack 127.0.0.1:8000 docker compose --file docker/compose.yaml
"""

from __future__ import annotations

import argparse
import asyncio
import io
import signal
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import httpx
from PIL import Image

from culet_protocol.messages import Message, Orbit, ToggleFall
from docker.claims import PATIENCE, check, until
from docker.confinement import check_confined
from docker.containers import Containers
from docker.watcher import Watcher, first_snapshot, watching
from e2e.units import LIVELY

HANG_PATIENCE = 240.0
"""Seconds until an engine that hangs is replaced: 20 s, or 150 s if a compiler was at work."""
MOST_WARNINGS = 20
"""Of four faults: a few for each, not one for each of a viewer's messages."""
NAMED_HOST = "gems.example"
"""`.ci/compose-test` lets the gateway go by this name, by CULET_ALLOW_HOST."""
TGA_FOOTER = b"TRUEVISION-XFILE.\0"
OCTAHEDRON = b"""OFF
6 8 0
1 0 0
-1 0 0
0 1 0
0 -1 0
0 0 1
0 0 -1
3 0 2 4
3 2 1 4
3 1 3 4
3 3 0 4
3 2 0 5
3 1 2 5
3 3 1 5
3 0 3 5
"""


class Stack:
    """The containers, and the gateway's address."""

    def __init__(self, address: str, http: httpx.AsyncClient, containers: Containers) -> None:
        self.http = http
        self.containers = containers
        self._address = address

    def stream(self, session: str) -> str:
        """Address of a session's WebSocket."""
        return f"ws://{self._address}/api/sessions/{session}/stream"

    async def tell(self, session: str, event: Message) -> None:
        """Do something to a session."""
        body = event.model_dump(mode="json")
        (await self.http.post(f"/api/sessions/{session}/events", json=body)).raise_for_status()

    async def ready(self) -> bool:
        """Whether gateway and engine serve."""
        try:
            return (await self.http.get("/readyz", timeout=5)).status_code == 200
        except httpx.TransportError:
            return False

    async def described(self, session: str) -> dict[str, Any]:
        """A session as it is now."""
        answer = (await self.http.get(f"/api/sessions/{session}")).raise_for_status()
        return {name: value for name, value in answer.json().items() if name != "viewers"}

    async def upload(self, kind: str, name: str, data: bytes) -> str:
        """Its id."""
        answer = (await self.http.post(f"/api/{kind}", files={"file": (name, data)})).raise_for_status()
        return str(answer.json()["id"])


async def check_answers(stack: Stack) -> None:
    """The page, a picture, and to which names the gateway answers."""
    page = await stack.http.get("/")
    check(page.status_code == 200 and "<canvas" in page.text, "the page is served")
    picture = await stack.http.get("/api/render.tga", params={"width": 320, "height": 180})
    data = picture.raise_for_status().content
    with Image.open(io.BytesIO(data)) as image:
        colours = image.getcolors(320 * 180) or []
        check(image.size == (320, 180), "a TGA of the size asked for comes")
    check(data.endswith(TGA_FOOTER), "it ends with the footer of TGA 2.0")
    check(len(colours) > 1000, f"it shows something: {len(colours)} colours")
    for name, status in ((NAMED_HOST, 200), ("evil.example", 421)):
        answer = await stack.http.get("/healthz", headers={"Host": name})
        check(answer.status_code == status, f"to the name {name} it answers {status}")


async def uploaded_scene(stack: Stack) -> dict[str, Any]:
    """One of an uploaded mesh under an uploaded sky, whose stone never comes to rest."""
    sky = io.BytesIO()
    Image.linear_gradient("L").resize((64, 32)).convert("RGB").save(sky, "PNG")
    mesh = await stack.upload("meshes", "octahedron.off", OCTAHEDRON)
    image = await stack.upload("skies", "sky.png", sky.getvalue())
    return LIVELY | {"stones": [{"mesh": mesh}], "environment": {"kind": "image", "image": image}}


@asynccontextmanager
async def fault(stack: Stack, watcher: Watcher, service: str, what: str) -> AsyncIterator[None]:
    """Something that is done to a service: another process must take over, and frames must come."""
    print(what, flush=True)
    await stack.containers.quiet(service)
    before = (await stack.containers.workers(service))[0]
    watcher.frames.clear()
    yield
    began = stack.containers.fault_at

    async def replaced() -> bool:
        return (await stack.containers.workers(service))[:1] not in ([], [before])

    async def frames_come() -> bool:
        return len(watcher.frames_since(moment)) >= 5

    await until(f"another {service} is at work", replaced, HANG_PATIENCE)
    await until("gateway and engine are ready", stack.ready)
    moment = time.monotonic()
    await until("frames come", frames_come)
    print(f"  = {watcher.seconds_to_frames(began):.1f} s from the fault to frames", flush=True)
    numbers = [frame.sequence for _, frame in watcher.frames]
    pictures = {(frame.sequence, frame.step, frame.timestamp) for _, frame in watcher.frames}
    check(numbers == sorted(numbers), "numbers of frames do not go back")
    check(len(pictures) == len(set(numbers)), "none is used for another picture")


async def pose(stack: Stack, session: str) -> Any:  # noqa: ANN401 - whatever the snapshot holds
    """Where the engine has the stone now, and all of its motion."""
    await stack.described(session)
    return (await first_snapshot(stack.stream(session)))["simulation"]


async def check_same(stack: Stack, session: str, scene: dict[str, Any], before: tuple[dict[str, Any], Any]) -> None:
    """The session is as it was, to the last bit, and what its scene was made of is there."""
    described, simulation = before
    check(await stack.described(session) == described, "session, scene and camera are the same")
    check(await pose(stack, session) == simulation, "the stone's pose is the same")
    answer = await stack.http.post("/api/sessions", json={"scene": scene})
    check(answer.status_code == 201, "its uploads can be used in another session")
    (await stack.http.delete(f"/api/sessions/{answer.json()['id']}")).raise_for_status()


async def check_faults(stack: Stack) -> None:
    """What happens to a session that is watched while processes die and hang."""
    containers = stack.containers
    scene = await uploaded_scene(stack)
    session = str((await stack.http.post("/api/sessions", json={"scene": scene})).raise_for_status().json()["id"])
    async with watching(stack.stream(session)) as watcher:
        await check_killed_engine(stack, watcher, session)
        if (await stack.described(session))["falling"]:
            await stack.tell(session, ToggleFall())
        await stack.tell(session, Orbit(yaw=0.3, pitch=0.1))
        before = await stack.described(session), await pose(stack, session)
        check(not before[0]["falling"], "the stone is held")
        check(before[1] is not None, "it has a pose")

        engine = (await containers.workers("engine"))[0]
        async with fault(stack, watcher, "gateway", "the gateway is killed"):
            await containers.kill("gateway")
        check((await containers.workers("engine"))[0] == engine, "the engine is the one from before")
        await check_same(stack, session, scene, before)

        async with fault(stack, watcher, "engine", "the engine's event loop stands still"), containers.held("loop"):
            pass
        await check_same(stack, session, scene, before)
        async with fault(stack, watcher, "engine", "the engine's rendering stands still"), containers.held("rendering"):
            pass
        await check_same(stack, session, scene, before)
        async with fault(stack, watcher, "engine", "the engine is stopped as a whole"):
            await containers.kill("engine", signal.SIGSTOP)
        await check_same(stack, session, scene, before)
        for service in ("engine", "gateway"):
            restarts = await containers.restarts(service)
            async with fault(stack, watcher, service, f"all that runs in the {service}'s container is killed"):
                await containers.kill_all(service)
            check(await containers.restarts(service) > restarts, f"Docker has started the {service} again")
            await check_same(stack, session, scene, before)
    (await stack.http.delete(f"/api/sessions/{session}")).raise_for_status()
    warnings = (await containers.log("gateway")).count(" WARNING ")
    check(warnings <= MOST_WARNINGS, f"the gateway's log has {warnings} warnings of all that")


async def check_killed_engine(stack: Stack, watcher: Watcher, session: str) -> None:
    """A stone that falls goes on."""

    async def falls() -> bool:
        return bool(watcher.frames) and watcher.frames[-1][1].simulation_time > 0.2

    async with fault(stack, watcher, "engine", "the engine is killed while a stone falls"):
        await stack.tell(session, ToggleFall())
        await until("the stone falls", falls)
        last = watcher.frames[-1][1].simulation_time
        await stack.containers.kill("engine")
    now = watcher.frames[-1][1].simulation_time
    check(now >= last, f"the fall goes on: t = {last:.2f} s before, {now:.2f} s after")


async def check_second_engine(stack: Stack) -> None:
    """A gateway that starts before two engines says that it serves one; the one that was there goes on."""
    await stack.containers.scale("engine", 2)
    told = "one gateway serves one engine"
    await stack.containers.compose("run", "--rm", "--no-deps", "--no-TTY", "gateway", fails=told)
    check(True, f"before two engines a gateway does not start: {told}")
    await stack.containers.scale("engine", 1)
    check(await stack.ready(), "the gateway that had one has it still")


async def main() -> None:
    """Ask for everything, in order."""
    parser = argparse.ArgumentParser()
    parser.add_argument("address", help="host:port of the gateway")
    parser.add_argument("compose", nargs=argparse.REMAINDER, help="docker compose, with what names the project")
    arguments = parser.parse_args()
    async with httpx.AsyncClient(base_url=f"http://{arguments.address}", timeout=PATIENCE) as http:
        stack = Stack(arguments.address, http, Containers(arguments.compose))
        await until("the gateway is ready", stack.ready)
        for service in ("engine", "gateway"):
            await check_confined(await stack.containers.one(service), service)
        await check_answers(stack)
        await check_second_engine(stack)
        await check_faults(stack)
        await check_answers(stack)


if __name__ == "__main__":
    asyncio.run(main())
