"""What honest viewers keep while somebody else takes all that can be had."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import socket
import sys
import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
from websockets.asyncio.client import connect
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from hostile.finding import Finding, Group, span
from hostile.serving import FALLING, PATIENCE, Serving
from hostile.watching import watching

TESTS = str(Path(__file__).parents[1])
SETTLING = 1.0
"""s in which a governor finds its size."""
BEFORE_SECONDS = 1.0
SPARE_SECONDS = 8.0
"""After which those that stand by are loaded."""
PAUSE = 0.002
"""s between two small requests."""
OTHER_ADDRESS = "127.0.0.2"
"""Of loopback too: the next visitor, whose connections are counted apart."""

DEAREST: Mapping[str, Any] = {
    **FALLING,
    "optics": {"bands": 64, "polarised": True, "cutoff": 1e-9, "max_bounces": 65536},
    "walls": {"kind": "mirror"},
    "floor": {"kind": "mirror"},
    "stones": [{"material": {"ior": [10, 10, 10]}, "position": [0, 4, 0]}],
}
"""A scene that asks for everything: a frame of it takes minutes."""

Attack = Callable[[Serving], AbstractAsyncContextManager[str]]
"""Goes on until it is left; gives a word on what it has done."""


async def viewers_of_one_session(serving: Serving, viewers: int, seconds: float) -> Finding:
    """Many pages on one falling stone."""
    session = serving.falling()
    async with watching(serving, [session] * viewers) as watchers:
        await asyncio.sleep(SETTLING)
        began = time.monotonic()
        await asyncio.sleep(seconds)
        rates = [watcher.rate(began, time.monotonic()) for watcher in watchers]
    serving.forget(session)
    return Finding(
        Group.LOAD,
        f"{viewers} viewers of one falling stone, 320x180, {seconds:g} s",
        f"{span(rates, 'frames/s each')}",
        "the slowest gets at least 0.8 of the fastest",
        min(rates) >= 0.8 * max(rates) > 0,
    )


async def falling_sessions(serving: Serving, sessions: int, seconds: float, size: tuple[int, int]) -> Finding:
    """As many stones as sessions, all falling, each watched."""
    opened = [serving.falling() for _ in range(sessions)]
    async with watching(serving, opened, size) as watchers:
        await asyncio.sleep(SETTLING)
        began = time.monotonic()
        await asyncio.sleep(seconds)
        ended = time.monotonic()
        rates = [watcher.rate(began, ended) for watcher in watchers]
        gap = max(watcher.longest_gap(began, ended) for watcher in watchers)
    serving.forget(*opened)
    return Finding(
        Group.LOAD,
        f"{sessions} sessions with a falling stone, one viewer each, pages of {size[0]}x{size[1]}, {seconds:g} s",
        f"{span(rates, 'frames/s each')}, longest pause {gap:.2f} s",
        "the slowest gets at least 0.5 of the fastest",
        min(rates) >= 0.5 * max(rates) > 0,
    )


async def memory_of_heaps(serving: Serving, sessions: int, stones: int, seconds: float, most: float) -> Finding:
    """MB of the engine while sessions of so many stones each, of which no two are cut alike, are watched and fall."""
    opened = [serving.session(_heap(number, stones)) for number in range(sessions)]
    resident, proportional = [], []
    async with watching(serving, opened, (640, 360)) as watchers:
        for session in opened:
            serving.http.post(f"/api/sessions/{session}/events", json={"type": "toggle_fall"}).raise_for_status()
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            await asyncio.sleep(seconds / 20)
            memory = serving.engine.memory_full_info()
            resident.append(memory.rss / 1e6)
            proportional.append(memory.pss / 1e6)
        frames = min(len(watcher.seen) for watcher in watchers)
    serving.forget(*opened)
    return Finding(
        Group.LOAD,
        f"{sessions} sessions of {stones} falling stones, each of a cut of its own, watched, {seconds:g} s",
        f"the engine takes {max(resident):.0f} MB at most ({max(proportional):.0f} of its own); "
        f"{frames} frames of each session at least",
        f"under {most:g} MB, and all are seen",
        max(resident) < most and frames > 1,
    )


def _heap(session: int, stones: int) -> dict[str, Any]:
    """Above each other in twos, over the matte floor."""
    return {
        "floor": {"kind": "matte"},
        "stones": [
            {
                "position": [2.5 * (number % 2), 1 + 2.2 * (number // 2), 0.1 * (number % 3)],
                "cut": {"crown_degrees": 32 + 0.01 * (session * stones + number)},
                "material": ("diamond", "ruby", "sapphire")[number % 3],
            }
            for number in range(stones)
        ],
    }


async def slow_readers(serving: Serving, readers: int, keeps: float, most: float, seconds: float) -> Finding:
    """What a viewer of a falling stone keeps while so many others of the same session read nothing, and the MB by which
    the gateway grows."""
    session = serving.falling()
    async with watching(serving, [session]) as (watcher,), contextlib.AsyncExitStack() as stack:

        async def measured() -> float:
            await asyncio.sleep(SETTLING)
            began = time.monotonic()
            await asyncio.sleep(seconds)
            return watcher.rate(began, time.monotonic())

        before, held = await measured(), serving.gateway.memory_full_info().rss
        url = f"{serving.stream_url}/api/sessions/{session}/stream"
        for _ in range(readers):
            connection = await stack.enter_async_context(
                connect(
                    url, subprotocols=[Subprotocol(SUBPROTOCOL)], max_size=None, max_queue=1, compression=None,
                    proxy=None, ping_interval=None, close_timeout=0.1,
                )
            )  # fmt: skip
            await connection.send(json.dumps({"type": "resize", "width": 1280, "height": 720}))
        during = await measured()
        grown = (serving.gateway.memory_full_info().rss - held) / 1e6
    serving.forget(session)
    share = during / before
    return Finding(
        Group.SHARES,
        f"{readers} viewers of the same session that read nothing",
        f"another viewer keeps {100 * share:.0f} % of its rate ({during:.1f} of {before:.1f} frames/s); the gateway "
        f"takes {grown:.0f} MB more",
        f"at least {100 * keeps:.0f} %, and at most {most:g} MB",
        share >= keeps and grown <= most,
    )


async def beside(serving: Serving, name: str, attack: Attack, keeps: float, seconds: float) -> Finding:
    """The rate of a viewer before, during and after an attack of another one."""
    session = serving.falling()
    async with watching(serving, [session]) as (watcher,):

        async def measured() -> float:
            await asyncio.sleep(SETTLING)
            began = time.monotonic()
            await asyncio.sleep(seconds)
            return watcher.rate(began, time.monotonic())

        before = await measured()
        async with attack(serving) as done:
            during = await measured()
        after = await measured()
    serving.forget(session)
    share = during / ((before + after) / 2)
    return Finding(
        Group.SHARES,
        f"{name}{done and f' ({done})'}",
        f"another viewer keeps {100 * share:.0f} % of its rate ({during:.1f} of {(before + after) / 2:.1f} frames/s)",
        f"at least {100 * keeps:.0f} %",
        share >= keeps,
    )


@contextlib.asynccontextmanager
async def dearest_scene(serving: Serving) -> AsyncIterator[str]:
    """One session of the dearest scene, falling, pinned to its best, on the largest page."""
    session = serving.session(DEAREST)
    async with _steering(serving, session) as say:
        await say({"type": "resize", "width": 2560, "height": 1440})
        await say({"type": "balance", "exactness": 1, "pinned": True})
        await say({"type": "toggle_fall"})
        try:
            yield ""
        finally:
            serving.forget(session)


def flood_of(kind: str) -> Attack:
    """One viewer of another session that sends as fast as it can, in a process of its own."""

    @contextlib.asynccontextmanager
    async def flood(serving: Serving) -> AsyncIterator[str]:
        session = serving.session(_heap(0, 12) if kind == "questions" else None)
        url = f"{serving.stream_url}/api/sessions/{session}/stream"
        sender = await asyncio.create_subprocess_exec(
            "nice", sys.executable, "-m", "hostile.flood", url, kind,
            env=os.environ | {"PYTHONPATH": TESTS}, stdout=asyncio.subprocess.PIPE,
        )  # fmt: skip
        try:
            assert sender.stdout
            async with asyncio.timeout(PATIENCE):  # or what is measured would be how Python starts
                assert await sender.stdout.readline(), "it ended before it sent anything"
            yield ""
        finally:
            sender.terminate()
            await sender.wait()
            serving.forget(session)

    return flood


resizes = flood_of("resize")
orbits = flood_of("orbit")
questions = flood_of("questions")
scatters = flood_of("scatter")
reaches = flood_of("reach")


@contextlib.asynccontextmanager
async def dearest_stills(serving: Serving) -> AsyncIterator[str]:
    """Eight of the largest pictures, of as much work as one may make; each takes minutes."""
    still = {
        "scene": {"sampling": {"samples_per_pixel": 32}, "optics": {"bands": 64}},
        "width": 8192,
        "height": 4096,
    }
    async with httpx.AsyncClient(base_url=serving.url, timeout=PATIENCE) as http:
        tasks = [asyncio.create_task(http.post("/api/render", json=still)) for _ in range(8)]
        try:
            async with asyncio.timeout(PATIENCE):
                while not any(task.done() for task in tasks):  # noqa: ASYNC110 - those over the client's limit
                    await asyncio.sleep(0.05)
            under_way = sum(not task.done() for task in tasks)
            assert under_way > 0, [task.result().text for task in tasks]
            yield f"{under_way} under way"
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)


async def half_sent_requests(serving: Serving, connections: int, within: float) -> Finding:
    """Requests whose heads never end; then a visitor from another address."""
    held: list[socket.socket] = []
    for _ in range(connections):
        with contextlib.suppress(OSError):
            one = socket.create_connection(("127.0.0.1", serving.port), timeout=PATIENCE)
            held.append(one)
            one.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ")
    began = time.monotonic()
    status = 0
    async with httpx.AsyncClient(
        transport=httpx.AsyncHTTPTransport(local_address=OTHER_ADDRESS), timeout=PATIENCE
    ) as other:
        with contextlib.suppress(httpx.HTTPError):
            status = (await other.get(f"{serving.url}/healthz")).status_code
    took = time.monotonic() - began
    for one in held:
        one.close()
    return Finding(
        Group.SHARES,
        f"{connections} half-sent requests from one address",
        f"the next visitor is answered {status} after {took:.2f} s" if status else "the next visitor is not answered",
        f"200 within {within:g} s",
        status == 200 and took < within,
    )


@dataclass(frozen=True)
class SentForm:
    """What became of a form, and of others meanwhile."""

    status: int
    """Of its answer."""
    seconds: float
    """From before its sender starts to its answer."""
    waits: list[float]
    """s of each small request of others."""


async def sent_form(serving: Serving, shape: str, mebibytes: int) -> SentForm:
    """By a process of its own, while others ask for something small again and again."""
    began = time.monotonic()
    sender = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "hostile.forms", str(serving.port), shape, str(mebibytes),
        env=os.environ | {"PYTHONPATH": TESTS}, stdout=asyncio.subprocess.PIPE,
    )  # fmt: skip
    answered = asyncio.create_task(sender.communicate())
    waits = await _waits(serving, answered)
    return SentForm(int((await answered)[0]), time.monotonic() - began, waits)


async def form(serving: Serving, shape: str, mebibytes: int, within: float) -> Finding:
    """An upload form of that shape, while others ask for something small again and again, as they did before."""
    before = max(await _waits(serving, asyncio.create_task(asyncio.sleep(BEFORE_SECONDS))))
    sent = await sent_form(serving, shape, mebibytes)
    status, during = sent.status, max(sent.waits)
    return Finding(
        Group.SHARES,
        f"an upload form of {mebibytes} MiB: {shape}",
        f"answered {status}; others wait {1000 * during:.0f} ms at most, {1000 * before:.0f} ms before",
        f"read or refused, and nobody waits over {1000 * within:g} ms more than before",
        (status == 201 or 400 <= status < 500) and during < before + within,
    )


async def forms(serving: Serving, sizes: Mapping[str, int], within: float) -> list[Finding]:
    """One of each shape, of so many MiB, once the processes that stand by are there."""
    await asyncio.sleep(SPARE_SECONDS)
    return [await form(serving, shape, size, within) for shape, size in sizes.items()]


async def _waits(serving: Serving, meanwhile: asyncio.Task[Any]) -> list[float]:
    """s of each small request, until something else is done."""
    waits: list[float] = []
    async with httpx.AsyncClient(base_url=serving.url, timeout=PATIENCE) as http:
        while not meanwhile.done() or len(waits) < 5:
            began = time.monotonic()
            (await http.get("/healthz")).raise_for_status()
            waits.append(time.monotonic() - began)
            await asyncio.sleep(PAUSE)
    return waits


@contextlib.asynccontextmanager
async def _steering(serving: Serving, session: str) -> AsyncIterator[Callable[[Mapping[str, Any]], Any]]:
    """A viewer that says things, and lets go of what it is sent."""
    url = f"{serving.stream_url}/api/sessions/{session}/stream"
    subprotocols = [Subprotocol(SUBPROTOCOL)]
    async with connect(url, subprotocols=subprotocols, max_size=None, compression=None, proxy=None) as connection:

        async def read() -> None:
            async for message in connection:
                if isinstance(message, bytes):
                    sequence = int.from_bytes(message[24:28], "little")
                    await connection.send(json.dumps({"type": "ack", "sequence": sequence}))

        reading = asyncio.create_task(read())
        try:
            yield lambda message: connection.send(json.dumps(message))
        finally:
            reading.cancel()
            await asyncio.gather(reading, return_exceptions=True)
