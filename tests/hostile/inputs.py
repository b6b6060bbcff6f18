"""Bytes that mean harm, by every door."""

from __future__ import annotations

import asyncio
import json
import random
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

import psutil
from websockets.asyncio.client import connect
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from hostile.files import SKIES, hdr_bomb, mutated, png_bomb
from hostile.finding import Finding, Group
from hostile.serving import MIB, PATIENCE, Serving
from hostile.watching import watching
from hostile.wire import close_code, malformed, opened

VALUES: Sequence[Any] = (
    None, True, 0, -1, 0.5, 1e308, 10**400, "", "x", "camera", "matte", [], {}, [0, 0, 0], {"kind": "mirror"},
    {"kind": "image", "image": "../../etc/passwd"}, {"stones": [{"mesh": "f" * 32}]}, {"camera": {"fov_degrees": 1e9}},
)  # fmt: skip
TYPES = (
    "orbit", "translate", "dolly", "reset_camera", "look_at_stone", "toggle_fall", "reset_stone", "push",
    "toggle_mirror", "toggle_environment", "toggle_walls", "patch_scene", "set_scene", "balance", "resize",
    "visibility", "ack", "ping", "hello", "state", "dance", "", None, 7,
)  # fmt: skip
FIELDS = (
    "target", "yaw", "pitch", "right", "up", "forward", "x", "y", "patch", "scene", "exactness", "pinned", "width",
    "height", "visible", "sequence", "time", "colour",
)  # fmt: skip

PROGRAM = 120.0
"""MiB of the reading process itself: an interpreter with NumPy and the reader's library."""


def message(dice: random.Random) -> str | bytes:
    """A control event, or something that looks like one, or nothing of the kind."""
    kind = dice.random()
    if kind < 0.1:
        return dice.randbytes(dice.randrange(200))
    if kind < 0.2:
        return dice.choice(("", "{", "[" * 10_000, "null", '"ping"', "NaN", "\ud7ff", '{"type":"ping","time":1e999}'))
    event: dict[str, Any] = {"type": dice.choice(TYPES)}
    event |= {dice.choice(FIELDS): dice.choice(VALUES) for _ in range(dice.randrange(5))}
    return json.dumps(event)


async def control_messages(serving: Serving, count: int, seed: int) -> Finding:
    """Messages of every shape on one stream, while somebody else watches another session."""
    dice = random.Random(seed)  # noqa: S311 - which message
    session, other = serving.session(), serving.falling()
    told: Counter[str] = Counter()
    url = f"{serving.stream_url}/api/sessions/{session}/stream"
    subprotocols = [Subprotocol(SUBPROTOCOL)]
    engine = serving.engine.pid
    async with watching(serving, [other]) as (watcher,):
        async with connect(url, subprotocols=subprotocols, max_size=None, compression=None, proxy=None) as connection:

            async def read() -> None:
                async for notice in connection:
                    if isinstance(notice, str):
                        told[json.loads(notice)["type"]] += 1

            reading = asyncio.create_task(read())
            for _ in range(count):
                await connection.send(message(dice))
            await connection.send('{"type": "ping", "time": 42}')
            async with asyncio.timeout(count / 20 + PATIENCE):
                while not told["pong"] and not reading.done():  # noqa: ASYNC110 - the condition is the server's
                    await asyncio.sleep(0.05)
            await connection.close()
            await asyncio.gather(reading, return_exceptions=True)  # it read until then: else the close is never heard
        await watcher.frame_after(time.monotonic())
    code = connection.close_code
    lives = serving.http.get(f"/api/sessions/{session}").status_code == 200 and serving.engine.pid == engine
    serving.forget(session, other)
    return Finding(
        Group.INPUTS,
        f"{count:,} control messages of every shape on one stream".replace(",", " "),
        f"{told['problem']} refusals told, then answered a ping; closed by {'itself' if code == 1000 else code}; "
        f"another session's frames go on",
        "no process dies, the session lives, the stream answers",
        lives and told["pong"] > 0 and code == 1000,
    )


async def websocket_frames(serving: Serving, count: int, seed: int) -> Finding:
    """Frames that RFC 6455 forbids, each on a connection of its own."""
    dice = random.Random(seed)  # noqa: S311 - which frame
    session = serving.session()
    codes: Counter[int | None] = Counter()
    for _ in range(count):
        one = await asyncio.to_thread(opened, serving.port, session)
        with one:
            one.sendall(malformed(dice))
            codes[await asyncio.to_thread(close_code, one)] += 1
    lives = serving.http.get(f"/api/sessions/{session}").status_code == 200
    serving.forget(session)
    closed = ", ".join(f"{number} with {code}" for code, number in codes.most_common() if code)
    return Finding(
        Group.INPUTS,
        f"{count} malformed WebSocket frames",
        f"closed: {closed or 'none'}; kept or dropped: {codes[None]}",
        "the session lives",
        lives,
    )


async def mutated_files(serving: Serving, count: int, seed: int) -> Finding:
    """Good files of every kind with bytes changed."""
    statuses: Counter[int] = Counter()
    engine = serving.engine.pid
    for ending, data in mutated(count, seed):
        where = "/api/skies" if ending in SKIES else "/api/meshes"
        while True:  # a client that sends this much is told to wait now and then
            answer = await asyncio.to_thread(serving.http.post, where, files={"file": (f"it.{ending}", data)})
            if answer.status_code != 429:
                break
            await asyncio.sleep(float(answer.headers.get("retry-after", 1)))
        statuses[answer.status_code] += 1
    read, refused = statuses[201], sum(number for code, number in statuses.items() if 400 <= code < 500)
    return Finding(
        Group.INPUTS,
        f"{count} mutated meshes and skies",
        f"{refused} refused, {read} read, {count - refused - read} answered otherwise",
        "each is read or refused, and the engine lives",
        refused + read == count and serving.engine.pid == engine,
    )


async def bombs(serving: Serving, largest: tuple[int, int]) -> list[Finding]:
    """Small files of large pictures."""
    found = []
    for ending, make in (("png", png_bomb), ("hdr", hdr_bomb)):
        data = make(*largest)
        began = time.monotonic()
        sending = asyncio.create_task(
            asyncio.to_thread(serving.http.post, "/api/skies", files={"file": (f"bomb.{ending}", data)})
        )
        peak = 0.0
        while not sending.done():
            peak = max(peak, _largest_reader(serving))
            await asyncio.sleep(0.02)
        status = (await sending).status_code
        kept = largest[0] * largest[1] * 12 / MIB
        found.append(
            Finding(
                Group.INPUTS,
                f"a .{ending} of {len(data) / 1024:.0f} kB that is {largest[0]}x{largest[1]} pixels",
                f"{status} after {time.monotonic() - began:.1f} s; the reader took at most {peak:.0f} MiB, "
                f"{kept:.0f} MiB are kept of such a picture",
                f"refused, or read with at most twice what is kept and {PROGRAM:g} MiB",
                400 <= status < 500 or (status == 201 and peak < 2 * kept + PROGRAM),
            )
        )
    return found


async def ever_other_skies(serving: Serving, count: int, budget: float) -> Finding:
    """One session that shows a sky after the other, each 96 MiB in memory and half a megabyte as a file."""
    session = serving.session()
    memory: list[float] = []
    async with watching(serving, [session], (64, 64)) as (watcher,):
        for number in range(count):
            data = hdr_bomb(4096, 2048, 20 + number)
            answer = await asyncio.to_thread(serving.http.post, "/api/skies", files={"file": ("sky.hdr", data)})
            if answer.status_code == 201:
                sky = {"environment": {"kind": "image", "image": answer.json()["id"]}}
                shown = time.monotonic()
                await asyncio.to_thread(serving.http.patch, f"/api/sessions/{session}", json=sky)
                await watcher.frame_after(shown)
            memory.append(serving.memory())
    serving.forget(session)
    return Finding(
        Group.INPUTS,
        f"one session that shows {count} skies of 4096x2048 one after the other",
        f"all processes together: {memory[0]:.0f} MiB after the first, {memory[count // 2]:.0f} after half, "
        f"{memory[-1]:.0f} at the end",
        f"never over {budget:.0f} MiB",
        max(memory) < budget,
    )


async def whole_interface(serving: Serving, examples: int, seed: int) -> Finding:
    """schemathesis makes requests from the interface's own description, good ones and bad ones: some 4600 for every
    value that the description has something to say about, and random ones."""
    command = [
        sys.executable, "-m", "schemathesis.cli", "run", f"{serving.url}/openapi.json", "--max-examples", str(examples),
        "--seed", str(seed), "--checks", "not_a_server_error", "--phases", "examples,coverage,fuzzing",
        "--exclude-path", "/api/drain",  # which it would end the server by
        "--suppress-health-check", "all", "--rate-limit", "100/s", "--request-timeout", str(PATIENCE), "--no-color",
    ]  # fmt: skip
    engine = serving.engine.pid
    with tempfile.TemporaryDirectory() as folder:  # for what it keeps
        ran = await asyncio.to_thread(subprocess.run, command, capture_output=True, text=True, check=False, cwd=folder)
    summary = re.search(r"\d+ generated, .*", ran.stdout)
    if ran.returncode != 0:
        print(ran.stdout[-4000:], ran.stderr[-1000:], sep="\n")  # what failed, and how to ask for it again
    return Finding(
        Group.INPUTS,
        f"schemathesis over the whole interface, up to {examples} random examples of each operation",
        f"{summary[0] if summary else ran.stdout[-300:]}",
        "no answer is a server error or missing, the engine lives",
        ran.returncode == 0 and serving.engine.pid == engine,
    )


def _largest_reader(serving: Serving) -> float:
    """MiB of the largest process that reads an upload."""
    largest = 0
    for process in serving.engine.children(recursive=True):
        try:
            largest = max(largest, process.memory_info().rss)
        except psutil.NoSuchProcess:
            continue
    return largest / MIB
