"""`culet study governor`: a real engine, one subscriber, and stones that fall again and again.

First the scene stays and its stones fall anew whenever all have come to rest; then things change while they fall:
walls, sky, floor, camera. What counts is what a viewer gets: the headers of its frames, and when they came.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
import os
import secrets
import subprocess
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from culet.engine.governing.governor import ERRORS, asked_rate, read_ladder
from culet.gateway.engine.link import EngineEvents, EngineLink
from culet.gateway.settings import GatewaySettings
from culet.scene import Scene
from culet.study.findings.provenance import commit, processor
from culet.study.serving.motion_record import (
    LATE_MS,
    SceneChange,
    SeenFrame,
    Settled,
    Summary,
    setting_shares,
    settle,
    summarise,
)
from culet_protocol.engine import CloseSession, Control, Demand, OpenSession
from culet_protocol.frame import Flags, Frame
from culet_protocol.messages import (
    Balance,
    Dolly,
    ResetCamera,
    ResetStone,
    SessionEvent,
    ToggleEnvironment,
    ToggleFall,
    ToggleMirror,
    ToggleWalls,
)
from culet_protocol.watch import watch_key

VIEWER_RATE = 60.0
"""Frames per second that the subscriber can take, as a browser's gateway says."""
START_SECONDS = 60.0
"""Patience with an engine that starts, and with the first frame: programs may have to be compiled."""
WARM_SECONDS = 4.0
"""Of falling that do not count: programs are compiled, the governor learns what a frame costs."""
GOAL = 0.75, 0.03
"""Of width and height, and the cut-off: what a frame of 1280x720 is to be at least, 960x540, or what misses no more."""
LEAST_SHARE = 0.005
"""Of the time: settings seen for less are told together."""
CHANGE_SECONDS = 4.0
"""Between two changes of the scene."""
CHANGES: tuple[tuple[str, SessionEvent], ...] = (
    ("walls", ToggleWalls()),
    ("light sky", ToggleEnvironment()),
    ("checker", ToggleMirror()),
    ("mirror again", ToggleMirror()),
    ("no walls", ToggleWalls()),
    ("studio again", ToggleEnvironment()),
    ("nearer", Dolly(forward=2.0)),
    ("far again", ResetCamera()),
)


@dataclass
class Recorder(EngineEvents):
    """Keeps the headers of one session's frames as they come, and knows whether the stone rests.

    That is a state of the last frame, not an event: whoever asks later is told the same, and `seen` may be emptied.
    """

    seen: list[SeenFrame] = field(default_factory=list)
    came: asyncio.Event = field(default_factory=asyncio.Event)
    """A frame has; cleared by whoever waits for the next one."""
    _last: Frame | None = None

    def frame_came(self, frame: Frame, message: bytes) -> None:
        """A frame has come."""
        self.seen.append(SeenFrame.of(frame, time.monotonic()))
        self._last = frame
        self.came.set()

    def at_rest(self, since: int) -> bool:
        """Whether the last frame shows a stone at rest, in the session's step `since` or a later one."""
        return self._last is not None and self._last.step >= since and Flags.MOVING not in self._last.flags

    async def rest(self, since: int) -> None:
        """Wait until it does."""
        while not self.at_rest(since):
            self.came.clear()
            await self.came.wait()


@dataclass(frozen=True)
class GovernorRecord:
    """All that was recorded, of the steady scene and of the changes."""

    steady: tuple[SeenFrame, ...]
    changing: tuple[SeenFrame, ...]
    changes: tuple[SceneChange, ...]
    processor_seconds: float
    """Of the engine, with the steady scene."""


class Play:
    """One session of a running engine."""

    def __init__(self, link: EngineLink, recorder: Recorder) -> None:
        self.session = secrets.token_hex(16)
        self._link = link
        self._recorder = recorder
        self._dropped = 0
        """The session's step with which the stone last began to fall; frames of earlier ones may still come."""

    async def open(self, scene: Scene, size: tuple[int, int], balance: Balance) -> None:
        """With one subscriber; returns when the first frame has come."""
        await self._link.request(OpenSession(session=self.session, scene=scene.model_dump(mode="json")))
        await self.control(balance)
        demand = Demand(session=self.session, frames_per_second=VIEWER_RATE, width=size[0], height=size[1])
        await self._link.request(demand)
        self._link.subscribe(watch_key(self.session))
        async with asyncio.timeout(START_SECONDS):
            await self._recorder.came.wait()

    async def control(self, event: SessionEvent) -> dict[str, Any]:
        """Apply an event; returns the session's `step` then, and whether it is `falling`."""
        answer, _ = await self._link.request(Control(session=self.session, event=event))
        return answer

    async def fall(self, seconds: float) -> None:
        """Let the stone fall, again and again, for so long."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(left):
                    await self._recorder.rest(self._dropped)
            if self._recorder.at_rest(self._dropped):  # outside the timeout: a drop is whole or not at all
                await self.drop()

    async def drop(self) -> None:
        """Put the stone back and let it fall."""
        await self.control(ResetStone())
        answer = await self.control(ToggleFall())
        self._dropped = answer["step"]

    async def close(self) -> None:
        """Forget the session."""
        await self._link.request(CloseSession(session=self.session))


async def measure(
    scene: Scene, seconds: float, size: tuple[int, int], exactness: float, *, changes: bool = True
) -> GovernorRecord:
    """Run an engine and play to it; takes the seconds and some ten more, and with `changes` half a minute more."""
    async with running_engine() as (link, process):
        recorder = Recorder()
        link.events = recorder
        play = Play(link, recorder)
        await play.open(scene, size, Balance(exactness=exactness, pinned=False))
        await play.drop()
        await play.fall(WARM_SECONDS)
        recorder.seen.clear()
        before = processor_seconds(process)
        await play.drop()
        await play.fall(seconds)
        spent = processor_seconds(process) - before
        steady = tuple(recorder.seen)
        recorder.seen.clear()
        made = []
        for name, event in CHANGES if changes else ():
            made.append(SceneChange(name, time.monotonic()))
            await play.control(event)
            await play.fall(CHANGE_SECONDS)
        await play.close()
        return GovernorRecord(steady, tuple(recorder.seen), tuple(made), spent)


def rate_of(exactness: float) -> float:
    """Frames per second that the governor is to hold."""
    return asked_rate(Balance(exactness=exactness, pinned=False), VIEWER_RATE)


@asynccontextmanager
async def running_engine() -> AsyncIterator[tuple[EngineLink, int]]:
    """An engine of its own: a connection to it, and its process id."""
    with tempfile.TemporaryDirectory(prefix="culet-") as folder:
        control, frames = f"ipc://{folder}/control", f"ipc://{folder}/frames"
        command = [sys.executable, "-m", "culet", "engine", "--control", control, "--frames", frames]
        with subprocess.Popen(command) as process:  # noqa: ASYNC220, S603 - it is there before anything else happens
            link = EngineLink(GatewaySettings(control=control, frames=frames))
            running = asyncio.create_task(link.run())
            try:
                async with asyncio.timeout(START_SECONDS):
                    await link.ready.wait()
                yield link, process.pid
            finally:
                running.cancel()
                await asyncio.gather(running, return_exceptions=True)
                process.terminate()


def processor_seconds(process: int) -> float:
    """User and system time of a process so far (proc(5): fields 14 and 15; a name may hold spaces)."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return sum(int(ticks) for ticks in fields[11:13]) / os.sysconf("SC_CLK_TCK")


def described(measured: GovernorRecord, size: tuple[int, int], rate: float) -> str:
    """A page of text."""
    milliseconds = 1e3 * measured.processor_seconds / max(1, len(measured.steady))
    rows = [
        f"asked for            {size[0]}x{size[1]}, {rate:g} frames/s",
        *_rows(summarise(measured.steady, rate)),
        f"processor            {milliseconds:.1f} ms a frame, on {os.cpu_count()} cores",
        *_share_rows(measured.steady, size),
    ]
    if not measured.changes:
        return "\n".join(rows)
    rows += [
        "",
        f"after a change       settled after   settings in {CHANGE_SECONDS:g} s",
        *(_change_row(settled) for settled in settle(measured.changing, measured.changes, rate)),
        "",
        "with all of these changes",
        *_rows(summarise(measured.changing, rate)),
    ]
    return "\n".join(rows)


def _rows(summary: Summary | None) -> list[str]:
    if summary is None:
        return ["of a moving stone    no two frames came of the same fall"]
    render = summary.render_ms_median, summary.render_ms_99, summary.render_ms_longest
    return [
        f"of a moving stone    {summary.moving_seconds:.1f} s",
        f"frames per second    {summary.frames_per_second:.2f}, {summary.late_intervals:.2%} late by half a frame",
        f"out of order         {summary.out_of_order} frames",
        f"simulated            {summary.pace:.3f} s a second",
        f"least size           {summary.lowest_size[0]}x{summary.lowest_size[1]}",
        f"largest cut-off      {summary.largest_cutoff:g}, {summary.fewest_bands} indices",
        f"fewest bounces       {summary.fewest_bounces}",
        "render ms            median {:.1f}, 99 % {:.1f}, longest {:.1f}".format(*render),
        f"in a row over {LATE_MS:g} ms  {summary.longest_late_run}",
        f"simulate, encode ms  median {summary.simulate_ms_median:.2f}, {summary.encode_ms_median:.2f}",
        f"stages together      {summary.side_by_side:.2f} of the time between frames",
        f"changes of setting   {summary.setting_changes_per_minute:.1f} a minute",
        "frontier's error     " + ("unknown" if summary.error_mean is None else f"mean {summary.error_mean:.4f}"),
    ]


def goal_error() -> float:
    """Root mean square of what is shown, 0 to 1, of frames of GOAL in the ladder, with all
    bounces."""
    scale, cutoff = GOAL
    return ERRORS.shown(scale, cutoff, max(rung.max_bounces for rung in read_ladder()))


def _share_rows(seen: Sequence[SeenFrame], size: tuple[int, int]) -> Iterator[str]:
    """How long each setting was seen, and what it misses."""
    shares, mean = setting_shares(seen, size, ERRORS)
    if not shares:
        return
    yield ""
    yield "share of the time    drawn       cut-off  bounces  error as shown"
    for share in shares:
        if share.share >= LEAST_SHARE:
            drawn = f"{share.width}x{share.height}"
            error = "unknown" if math.isnan(share.error) else f"{share.error:.4f}"
            yield f"{share.share:<20.1%} {drawn:<11} {share.cutoff:<8g} {share.max_bounces:<8} {error}"
    rest = [share.share for share in shares if share.share < LEAST_SHARE]
    if rest:
        yield f"{sum(rest):<20.1%} {len(rest)} others"
    scale, cutoff = GOAL
    goal, known = (
        f"{scale * size[0]:.0f}x{scale * size[1]:.0f} at {cutoff:g}",
        "unknown" if math.isnan(mean) else f"{mean:.4f}",
    )
    yield f"mean of all          {known}; of {goal} {goal_error():.4f}"


def _change_row(settled: Settled) -> str:
    when = f"not in {CHANGE_SECONDS:g} s" if settled.seconds is None else f"{settled.seconds:.2f} s"
    return f"{settled.name:<20} {when:<15} {settled.setting_changes + 1}"


def document(measured: GovernorRecord, size: tuple[int, int], rate: float) -> str:
    """JSON: the summary (null if nothing moved), and every frame's header."""
    summary = summarise(measured.steady, rate)
    shares, mean = setting_shares(measured.steady, size, ERRORS)
    frames = [asdict(seen) | {"error": None if math.isnan(seen.error) else seen.error} for seen in measured.steady]
    return json.dumps(
        {
            "commit": commit(),
            "processor": processor(),
            "size": size,
            "rate": rate,
            "steady": None if summary is None else summary.as_json(),
            "settings": [
                asdict(share) | {"error": None if math.isnan(share.error) else share.error} for share in shares
            ],
            "shown_error_mean": None if math.isnan(mean) else mean,
            "shown_error_goal": goal_error(),
            "processor_seconds": measured.processor_seconds,
            "changes": [asdict(settled) for settled in settle(measured.changing, measured.changes, rate)],
            "frames": frames,
        }
    )
