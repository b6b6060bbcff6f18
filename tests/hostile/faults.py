"""Processes that die or hang, at once or at random, while people watch."""

from __future__ import annotations

import asyncio
import random
import shutil
import signal
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx
import psutil

from hostile.finding import Finding, Group, span
from hostile.serving import FALLING, PATIENCE, Serving
from hostile.shares import OTHER_ADDRESS
from hostile.watching import watching

QUIET = 3.0
"""s between two deaths in a row."""
HUNG = {"engine": 25.0, "gateway": 40.0}
"""s after which one that does nothing must have been replaced; a gateway may be held up for 30, and goes on."""


def described(serving: Serving, session: str) -> Any:  # noqa: ANN401 - JSON
    """What the session is, but for what moves."""
    answer = serving.http.get(f"/api/sessions/{session}")
    assert answer.status_code == 200, answer.text
    scene = answer.json()["scene"]
    return {name: scene[name] for name in ("floor", "walls", "environment", "optics")}


async def killed(serving: Serving, part: str, times: int, within: float) -> Finding:
    """kill -9 of the engine or of the gateway, again and again, while a stone falls and one lies still."""
    sessions = [serving.falling(), serving.session({"floor": {"kind": "matte"}, "walls": {"kind": "mirror"}})]
    before = [described(serving, session) for session in sessions]
    seconds: list[float] = []
    async with watching(serving, sessions) as (watcher, _):
        for death in range(times):
            if death > 0:
                await asyncio.sleep(QUIET)
            process, moment = _process(serving, part), time.monotonic()
            serving.kill(process)
            seconds.append(await watcher.pause_after(moment))
    serving.until_ready()
    same = before == [described(serving, session) for session in sessions]
    serving.forget(*sessions)
    more = f"; then {span(seconds[1:], 's')}" if times > 1 else ""
    return Finding(
        Group.FAULTS,
        f"kill -9 of the {part}, {times} time{'s' * (times > 1)} in a row",
        f"viewers see nothing new for {seconds[0]:.1f} s{more}; scenes {'the same' if same else 'changed'}",
        f"the first time within {within:g} s, all scenes the same",
        seconds[0] <= within and same,
    )


async def killed_with_heavy_sessions(serving: Serving, sessions: int, stones: int) -> Finding:
    """kill -9 of the engine that has sessions of two clients whose shapes take long, and one of a third client.

    All are at rest by then, so that whatever comes later is of the next engine.
    """
    with _client(serving, "127.0.0.3") as second, _client(serving, OTHER_ADDRESS) as third:
        owners = [(serving.http, second)[number % 2] for number in range(sessions)]
        opened = [serving.session(_recut(number, stones), owner) for number, owner in enumerate(owners)]
        light = serving.session(http=third)
    before = [serving.http.get(f"/api/sessions/{session}").json()["scene"] for session in opened]
    async with watching(serving, [light, *opened], (160, 90)) as (first, *watchers):
        for watcher in (first, *watchers):
            await watcher.rest()
        process, moment = serving.engine, time.monotonic()
        serving.kill(process)
        quick = await first.frame_after(moment)
        seconds = [await watcher.frame_after(moment) for watcher in watchers]
        lost = [notice for watcher in watchers for notice in watcher.notices if notice.get("code") == "session_lost"]
    same = before == [serving.http.get(f"/api/sessions/{session}").json()["scene"] for session in opened]
    serving.forget(light, *opened)
    return Finding(
        Group.FAULTS,
        f"kill -9 of the engine with {sessions} sessions of {stones} recut stones of two clients, and one of a third",
        f"the third's is seen after {quick:.1f} s, all of these after {span(seconds, 's')}; {len(lost)} called lost; "
        f"scenes {'the same' if same else 'changed'}",
        "the third's before all of these, none is called lost, all scenes the same",
        quick < min(seconds) and not lost and same,
    )


def _client(serving: Serving, address: str) -> httpx.Client:
    """Of another address of loopback."""
    transport = httpx.HTTPTransport(local_address=address)
    return httpx.Client(base_url=serving.url, transport=transport, timeout=PATIENCE)


def _recut(session: int, stones: int) -> dict[str, Any]:
    """So many stones, of which no two are cut alike."""
    return {
        "stones": [
            {
                "position": [2.5 * (number % 8), 1, 2.5 * (number // 8)],
                "recut": {"angles": {"4": 42.5 + 0.001 * (session * stones + number)}},
            }
            for number in range(stones)
        ]
    }


async def hung(serving: Serving, part: str) -> Finding:
    """A process that is stopped, and never goes on."""
    session = serving.falling()
    async with watching(serving, [session]) as (watcher,):
        process = _process(serving, part)
        moment = time.monotonic()
        serving.kill(process, signal.SIGSTOP)
        try:
            took = await watcher.pause_after(moment)
        finally:
            serving.kill(process, signal.SIGCONT)
    serving.forget(session)
    return Finding(
        Group.FAULTS,
        f"the {part} hangs (SIGSTOP)",
        f"replaced; frames again after {took:.1f} s",
        f"within {HUNG[part]:g} s",
        took <= HUNG[part],
    )


async def cache_removed(serving: Serving, cache: Path) -> Finding:
    """The folder of compiled kernels goes while the engine runs; then scenes that need new programs."""
    shutil.rmtree(cache)
    scenes = [{"environment": {"kind": kind}, "floor": {"kind": "matte"}} for kind in ("half", "gradient", "constant")]
    statuses = []
    for scene in scenes:
        answer = await asyncio.to_thread(
            serving.http.post, "/api/render", json={"scene": scene, "width": 64, "height": 36}
        )
        statuses.append(answer.status_code)
    return Finding(
        Group.FAULTS,
        "the folder of compiled kernels is removed under way",
        f"{len(scenes)} scenes that need new programs: {', '.join(map(str, statuses))}",
        "200 for all",
        statuses == [200] * len(scenes),
    )


async def chaos(serving: Serving, viewers: int, sessions: int, seconds: float, between: float, seed: int) -> Finding:
    """Both processes are killed at random while many watch, and some steer."""
    dice = random.Random(seed)  # noqa: S311 - which process dies when
    opened = [serving.session({**FALLING, "walls": {"kind": "matte"}}) for _ in range(sessions)]
    before = [described(serving, session) for session in opened]
    deaths = {"engine": 0, "gateway": 0}
    async with watching(serving, [opened[n % sessions] for n in range(viewers)]) as watchers:
        for watcher in watchers[:sessions]:
            await watcher.say({"type": "toggle_fall"})
        ends = time.monotonic() + seconds
        while time.monotonic() < ends:
            await asyncio.sleep(dice.uniform(0.2, 1.8) * between)
            part = dice.choice(list(deaths))
            serving.kill(_process(serving, part))
            deaths[part] += 1
        last = time.monotonic()
        back = [await watcher.pause_after(last) for watcher in watchers]
        gaps = [watcher.longest_gap(ends - seconds, time.monotonic()) for watcher in watchers]
        backwards = sum(after < first for watcher in watchers for (_, first), (_, after) in pairwise(watcher.seen))
    serving.until_ready()
    same = before == [described(serving, session) for session in opened]
    serving.forget(*opened)
    return Finding(
        Group.FAULTS,
        f"{seconds / 60:.3g} minutes of chaos: engine killed {deaths['engine']} times, gateway {deaths['gateway']} "
        f"times, at random, {viewers} viewers of {sessions} sessions",
        f"all {viewers} see frames again, after {span(back, 's')} the last time; longest pause of all {max(gaps):.1f} "
        f"s; {backwards} frame numbers went back; scenes {'the same' if same else 'changed'}",
        "all see frames again, no number goes back, all scenes the same, the server lives",
        serving.alive and same and backwards == 0,
    )


def _process(serving: Serving, part: str) -> psutil.Process:
    return serving.engine if part == "engine" else serving.gateway
