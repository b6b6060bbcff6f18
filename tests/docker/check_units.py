"""What must be had from units behind the proxy, also after what can happen to one. `make compose-test` calls this.

CULET_TOKEN=... CULET_ALLOW_HOST=... PYTHONPATH=tests python -m docker.check_units \\
    127.0.0.1:8443 127.0.0.1:8080 site.pem docker compose --file docker/units.yaml
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import shutil
import ssl
import time
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager

import httpx
from playwright.async_api import Browser, Page, async_playwright
from websockets.asyncio.client import ClientConnection

from culet_protocol import WATCH_SUBPROTOCOL
from culet_protocol.frame import Frame
from culet_protocol.messages import Resize, ToggleFall
from docker.claims import PATIENCE, check, until
from docker.confinement import check_confined
from docker.containers import KILL, Container, Containers
from docker.site import Site
from docker.watcher import watching
from e2e.conftest import ARGUMENTS
from e2e.units import LIVELY

LINKS = 20
SPREAD = 12
"""Sessions that are shared among three units, and among four."""
TIME_OF = "culet.lastFrame.simulationTime"
ENGINES = """
import json, pathlib
found = []
for folder in pathlib.Path("/proc").glob("[0-9]*"):
    words = (folder / "cmdline").read_bytes().split(b"\\0")
    if b"engine" in words:
        found.append((int((folder / "stat").read_text().rpartition(") ")[2].split()[19]), int(folder.name)))
print(json.dumps([process for _, process in sorted(found)]))
"""
"""Run in a unit: its engines by age, of which the first works and the others stand by."""


async def until_spread(site: Site) -> None:
    """Wait until each unit gets new sessions."""

    units = await site.units()
    check(len(units) > 1, f"{len(units)} units run")

    async def spread() -> bool:
        made = [(await site.make())["id"] for _ in units]
        held = await site.holders(*made)
        await site.delete(*made)
        return all(any(row) for row in held)

    await until(f"each of {len(units)} units is given sessions", spread)


async def check_spread(site: Site) -> None:
    """New sessions go to the units in turn."""
    units = len(await site.units())
    made = [(await site.make())["id"] for _ in range(SPREAD)]
    held = [sum(row) for row in await site.holders(*made)]
    check(held == [SPREAD // units] * units, f"of {SPREAD} sessions the units have {held}")
    await site.delete(*made)


async def check_tls(site: Site, plain: str) -> None:
    """Whoever comes by plain http is sent to https, and browsers remember."""
    async with httpx.AsyncClient(base_url=f"http://{plain}") as http:
        answer = await http.get("/?a=b")
        sent = answer.status_code, answer.headers["location"]
        check(sent == (308, f"https://{plain}/?a=b"), f"plain http is sent on: {sent}")
    async with site.client() as http:
        page = await http.get("/")
        check(page.status_code == 200 and "<canvas" in page.text, "the page is served by TLS")
        check("max-age" in page.headers.get("strict-transport-security", ""), "by TLS alone from then on")
        refused = await http.post("/api/sessions", json={"preset": "matte"})
        check(refused.status_code == 401, "without the token no session is made")
        for name, status in ((os.environ["CULET_ALLOW_HOST"], 200), ("evil.example", 421)):
            answer = await http.get("/healthz", headers={"Host": name})
            check(answer.status_code == status, f"to the name {name} they answer {status}")


async def frame_of(stream: ClientConnection) -> Frame:
    """The next one."""
    await stream.send(Resize(width=64, height=36).model_dump_json())
    async with asyncio.timeout(PATIENCE):
        while isinstance(message := await stream.recv(), str):
            check(json.loads(message)["type"] != "problem", message) if "problem" in message else None
    return Frame.unpack(message)


async def check_links(site: Site) -> None:
    """As pages open them, half of them to steer and half to watch: all at once, and without a cookie."""
    made = [await site.make() for _ in range(LINKS)]
    held = await site.holders(*(each["id"] for each in made))
    check(all(sum(column) == 1 for column in zip(*held, strict=True)), f"each of {LINKS} sessions is in one unit")
    streams: list[ClientConnection] = []
    async with AsyncExitStack() as opened:
        for number, each in enumerate(made):
            steers = number % 2 == 1
            path = f"/api/sessions/{each['id']}/stream" if steers else "/api/stream"
            protocols = () if steers else (WATCH_SUBPROTOCOL + each["watch"],)
            stream = await opened.enter_async_context(site.open(path, *protocols))
            hello = json.loads(await stream.recv())
            if (hello["type"], hello["watch"], hello["steers"]) != ("hello", each["watch"], steers):
                check(False, f"a link leads to its session: {hello}")
            streams.append(stream)
        for stream, each in zip(
            streams, made, strict=True
        ):  # which all are watched, while a unit compiles for the first
            if (await frame_of(stream)).watch.hex() != each["watch"]:
                check(False, "frames of that session come")
        numbers = [sum(row) for row in held]
        check(min(numbers) > 0, f"{LINKS} links to {LINKS} sessions in units that have {numbers} show them by TLS")
        check(await site.viewers() == numbers, "the units have as many viewers")

    async def alone() -> bool:
        return not any(await site.viewers())

    await until("viewers that leave are gone", alone)
    await site.delete(*(each["id"] for each in made))


async def falling(site: Site) -> str:
    """A session in which a ball bounces for ever."""
    session = (await site.make(scene=LIVELY))["id"]
    await site.tell(session, ToggleFall().model_dump(mode="json"))
    return session


async def holder(site: Site, session: str) -> Container:
    """The unit that has a session."""
    units = await site.units()
    (number,) = [number for number, (has,) in enumerate(await site.holders(session)) if has]
    return units[number]


async def check_killed_engine(site: Site) -> None:
    """Another one stands by, and goes on where it was."""
    print("a unit's engine is killed while a stone falls", flush=True)
    session = await falling(site)
    unit = await holder(site, session)

    async def stands_by() -> bool:
        return len(json.loads(await unit.python(ENGINES))) > 1

    await until("another engine stands by", stands_by)
    async with watching(site.stream(f"/api/sessions/{session}/stream"), site.context) as watcher:

        async def falls() -> bool:
            return bool(watcher.frames) and watcher.frames[-1][1].simulation_time > 0.2

        async def frames_come() -> bool:
            return len(watcher.frames_since(killed)) >= 5 and watcher.frames[-1][1].simulation_time > before

        await until("the stone falls", falls)
        engine, *others = json.loads(await unit.python(ENGINES))
        before, killed = watcher.frames[-1][1].simulation_time, time.monotonic()
        await unit.python(KILL, str(engine), "9")
        killed = time.monotonic()
        await until("the fall goes on", frames_come)
        print(f"  = {watcher.seconds_to_frames(killed):.1f} s from the fault to frames", flush=True)
        check(json.loads(await unit.python(ENGINES))[0] in others, "the engine that stood by has taken over")
        check((await unit.inspect())["RestartCount"] == 0, "the unit was not started again")
    await site.delete(session)


async def until_true(page: Page, expression: str, claim: str) -> None:
    """Wait for what a page's script says: again and again, as the page allows no string to be run by itself."""

    async def holds() -> bool:
        return bool(await page.evaluate(expression))

    await until(claim, holds)


@asynccontextmanager
async def pages(site: Site, session: str, number: int) -> AsyncIterator[list[Page]]:
    """Pages of a session, each in a browser's profile of its own."""
    executable = os.environ.get("CULET_CHROMIUM") or shutil.which("chromium")
    async with async_playwright() as playwright:
        browser: Browser = await playwright.chromium.launch(executable_path=executable, args=ARGUMENTS)
        found = []
        for _ in range(number):
            context = await browser.new_context(ignore_https_errors=True, viewport={"width": 384, "height": 216})
            page = await context.new_page()
            await page.goto(f"{site.url}/?session={session}#token={site.token}")
            await until_true(page, "!!window.culet && culet.framesShown > 0", "a page shows the session")
            found.append(page)
        yield found
        await browser.close()


async def check_killed_unit(site: Site) -> None:
    """Its pages go on by themselves, in another one."""
    print("a unit is killed while two pages show a stone that falls", flush=True)
    session = await falling(site)
    async with pages(site, session, 2) as shown:
        for page in shown:
            await until_true(page, f"{TIME_OF} > 2", "the stone falls")
        unit = await holder(site, session)
        before = [float(await page.evaluate(TIME_OF)) for page in shown]
        killed = time.monotonic()
        await unit.kill()
        for page, moment in zip(shown, before, strict=True):
            await until_true(page, f"{TIME_OF} > {moment + 0.5}", "a page shows how it falls on")
        print(f"  = {time.monotonic() - killed:.1f} s from the death to both pages", flush=True)
        for page in shown:
            await until_true(page, "culet.state.falling", "a page says that it falls")
        held = [has for (has,) in await site.holders(session)]
        check(sum(held) == 1, "both found the same unit")
    await site.delete(session)
    await unit.start()
    await until_spread(site)


async def check_one_more(site: Site) -> None:
    """It is found, and gets its share."""
    print("one more unit is asked for", flush=True)
    before = [unit.identity for unit in await site.units()]
    session = (await site.make())["id"]
    async with watching(site.stream(f"/api/sessions/{session}/stream"), site.context) as watcher:

        async def frames_come() -> bool:
            return len(watcher.frames_since(moment)) >= 5

        await site.containers.scale("unit", len(before) + 1)
        units = [unit.identity for unit in await site.units()]
        check(len(units) == len(before) + 1 and set(before) < set(units), "those that were there are left alone")
        await until_spread(site)
        await check_spread(site)
        moment = time.monotonic()
        await until("who watched sees frames as before", frames_come)
    await site.delete(session)


async def check_drain(site: Site) -> None:
    """One unit less: who is there is told and may stay, and nobody new comes."""
    print("one unit less is asked for while each has a viewer", flush=True)
    units = await site.units()
    made = [await site.make() for _ in units]
    held = await site.holders(*(each["id"] for each in made))
    check(all(sum(row) == 1 for row in held), "each has a session")
    leaving: set[int] = set()

    async def listen(number: int, stream: ClientConnection) -> None:
        async for message in stream:
            if isinstance(message, str) and json.loads(message)["type"] == "leaving":
                leaving.add(number)

    async def told() -> bool:
        return bool(leaving)

    async with AsyncExitStack() as opened, asyncio.TaskGroup() as group:
        streams, tasks = [], []
        for number, each in enumerate(made):
            path = f"/api/sessions/{each['id']}/stream"
            streams.append(await opened.enter_async_context(site.open(path)))
            tasks.append(group.create_task(listen(number, streams[-1])))
        fewer = group.create_task(site.containers.scale("unit", len(units) - 1))
        await until("a viewer is told", told)
        (number,) = leaving
        row = next(row for row in range(len(units)) if held[row][number])

        async def none_for_it() -> bool:
            others: list[str] = []
            with contextlib.suppress(httpx.HTTPStatusError):  # until the proxy has asked, the unit itself refuses
                while len(others) < len(units):
                    others.append((await site.make())["id"])
            free = len(others) == len(units) and not any((await site.holders(*others))[row])
            await site.delete(*others)
            return free

        await until("new sessions go to the others", none_for_it)
        async with site.client() as http:
            for name in (made[number]["id"], made[number]["watch"]):
                if (await http.get(f"/api/sessions/{name}")).status_code != 200:
                    check(False, "it keeps what it has")
        check(not fewer.done() and leaving == {number}, "it keeps what it has, and waits; the others are told nothing")
        await streams[number].close()
        await fewer
        left = {unit.identity for unit in await site.units()}
        check(left == {unit.identity for unit in units} - {units[row].identity}, "it ends once its viewer has left")
        others = [stream for one, stream in enumerate(streams) if one != number]
        for stream in others:
            await (await stream.ping())
        check(True, "those who watch the others see nothing of that")
        for task in tasks:
            task.cancel()
    await site.delete(*(each["id"] for one, each in enumerate(made) if one != number))


async def main() -> None:
    """Ask for everything, in order."""
    parser = argparse.ArgumentParser()
    parser.add_argument("address", help="host:port of the proxy, for TLS")
    parser.add_argument("plain", help="host:port of the proxy, for plain http")
    parser.add_argument("certificate", help="of the site: the file to believe")
    parser.add_argument("compose", nargs=argparse.REMAINDER, help="docker compose, with what names the project")
    arguments = parser.parse_args()
    context = ssl.create_default_context(cafile=arguments.certificate)
    site = Site(arguments.address, os.environ["CULET_TOKEN"], context, Containers(arguments.compose))
    await until_spread(site)
    for unit in await site.units():
        await check_confined(unit, "unit")
    await check_confined(await site.containers.one("proxy"), "proxy", culet=False)
    await check_tls(site, arguments.plain)
    await check_spread(site)
    await check_links(site)
    await check_killed_engine(site)
    await check_killed_unit(site)
    await check_one_more(site)
    await check_drain(site)


if __name__ == "__main__":
    asyncio.run(main())
