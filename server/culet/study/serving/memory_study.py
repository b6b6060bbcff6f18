"""`culet study memory`: what the engine's processes have while many sessions are watched: falling, refined, at rest.

A real engine, whose sessions all have a subscriber. What counts is the proportional set size of the engine and of what
descends from it: pages that processes share are counted once (proc(5), smaps_rollup).
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import secrets
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from culet.errors import CuletError
from culet.gateway.engine.link import EngineEvents, EngineLink
from culet.scene import Scene
from culet.study.findings.provenance import commit, processor
from culet.study.serving.crowd import family_of
from culet.study.serving.governor_study import START_SECONDS, VIEWER_RATE, running_engine
from culet_protocol.engine import Control, Demand, OpenSession, Status
from culet_protocol.frame import Flags, Frame
from culet_protocol.messages import ResetStone, ToggleFall
from culet_protocol.watch import watch_key

THROW_SECONDS = 4.0
"""Between two throws of each session's stones."""
WARM_SECONDS = 20.0
"""Of falling that do not count: programs are compiled, which takes more memory than anything else."""
FINAL_SECONDS = 600.0
"""Patience with pictures at rest; what they take until then is told anyway."""
SETTLE_SECONDS = 5.0
"""After which the engine has given back what it keeps for the next pictures."""
SAMPLE_SECONDS = 1.0

_PSS = re.compile(r"^Pss:\s+(\d+) kB$", re.MULTILINE)


@dataclass(frozen=True)
class Held:
    """What the engine's processes had during one state of its sessions."""

    state: str
    bytes: tuple[int, ...]
    """Proportional set size, a sample a second."""
    frames: int
    """That came meanwhile, of all sessions."""
    status: dict[str, int]
    """The engine's own account by kind, at the end."""

    @property
    def median(self) -> float:
        """Bytes."""
        return statistics.median(self.bytes)


@dataclass
class _Crowd(EngineEvents):
    """Knows of each session whether its last frame is final."""

    frames: int = 0
    final: dict[bytes, bool] = field(default_factory=dict)
    came: asyncio.Event = field(default_factory=asyncio.Event)
    """A frame has; cleared by whoever waits for the next one."""

    def frame_came(self, frame: Frame, message: bytes) -> None:
        self.frames += 1
        self.final[frame.watch] = Flags.FINAL in frame.flags
        self.came.set()

    async def until(self, there: Callable[[], bool], seconds: float) -> bool:
        """Wait for frames until it is so, but no longer than that; whether it is."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                while not there():
                    self.came.clear()
                    await self.came.wait()
        return there()

    @property
    def all_final(self) -> bool:
        """Whether nothing better will come for anybody."""
        return all(self.final.values())


async def measure(
    scene: Scene, sessions: int, size: tuple[int, int], seconds: float, *, final: bool = True
) -> list[Held]:
    """What an engine takes: with nothing open; with so many sessions whose stones fall, for so long; for so long of
    their pictures being refined; and, with `final`, when all are as good as they become."""
    async with running_engine() as (link, process):
        crowd = _Crowd()
        link.events = crowd
        found = [await _held("nothing open", link, crowd, process, SETTLE_SECONDS)]
        names = [secrets.token_hex(16) for _ in range(sessions)]
        for name in names:
            await link.request(OpenSession(session=name, scene=scene.model_dump(mode="json")))
            demand = Demand(session=name, frames_per_second=VIEWER_RATE, width=size[0], height=size[1])
            await link.request(demand)
            link.subscribe(watch_key(name))
        if not await crowd.until(lambda: len(crowd.final) == sessions, START_SECONDS):
            raise CuletError(
                f"expected frames of {sessions} sessions within {START_SECONDS:g} s, got {len(crowd.final)}"
            )
        throwing = asyncio.create_task(_throw(link, names))
        await asyncio.sleep(WARM_SECONDS)
        found.append(await _held("falling", link, crowd, process, seconds))
        throwing.cancel()
        await asyncio.gather(throwing, return_exceptions=True)
        await asyncio.sleep(THROW_SECONDS)
        found.append(await _held("refined", link, crowd, process, seconds))
        if final and await crowd.until(lambda: crowd.all_final, FINAL_SECONDS):
            await asyncio.sleep(SETTLE_SECONDS)
            found.append(await _held("final", link, crowd, process, SETTLE_SECONDS))
        return found


async def _throw(link: EngineLink, names: Sequence[str]) -> None:
    """Put all stones back and let them fall, again and again; sessions one after the other."""
    while True:
        for name in names:
            for event in (ResetStone(), ToggleFall()):
                answer, _ = await link.request(Control(session=name, event=event))
            if not answer["falling"]:  # it was falling when it was put back
                await link.request(Control(session=name, event=ToggleFall()))
            await asyncio.sleep(THROW_SECONDS / len(names))


async def _held(state: str, link: EngineLink, crowd: _Crowd, process: int, seconds: float) -> Held:
    before, end, sizes = crowd.frames, time.monotonic() + seconds, []
    while time.monotonic() < end:
        sizes.append(proportional_set_size(process))
        await asyncio.sleep(SAMPLE_SECONDS)
    answer, _ = await link.request(Status())
    return Held(state, tuple(sizes), crowd.frames - before, _by_kind(answer))


def _by_kind(status: dict[str, Any]) -> dict[str, int]:
    found = ((re.fullmatch(r"memory_(\w+)_bytes", name), size) for name, size in status.items())
    return {match[1]: size for match, size in found if match is not None and match[1] != "budget"}


def proportional_set_size(process: int) -> int:
    """Bytes of a process and of all that descend from it; pages that several have are divided among them."""
    found = 0
    for each in family_of(process):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            rollup = Path(f"/proc/{each}/smaps_rollup").read_text(encoding="ascii")
            found += sum(1024 * int(size) for size in _PSS.findall(rollup))
    return found


def described(measured: Sequence[Held]) -> str:
    """A table, and what of it the engine accounts for."""
    rows = ["sessions       median MiB  most MiB  frames  of these, MiB at the end"]
    for held in measured:
        kinds = ", ".join(f"{kind} {size / 2**20:.0f}" for kind, size in held.status.items() if size >= 2**20)
        most = max(held.bytes)
        rows.append(f"{held.state:<14} {held.median / 2**20:<11.0f} {most / 2**20:<9.0f} {held.frames:<7} {kinds}")
    return "\n".join(rows)


def document(measured: Sequence[Held], sessions: int, size: tuple[int, int]) -> str:
    """JSON of all samples."""
    return json.dumps(
        {
            "commit": commit(),
            "processor": processor(),
            "sessions": sessions,
            "size": size,
            "held": [asdict(held) for held in measured],
        }
    )
