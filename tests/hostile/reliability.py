"""`make reliability`: runs the long trials and writes the table of docs/explanation/reliability.md.

    python -m hostile.reliability [--into FILE] [--part PART] [NAME...]

Each trial has a `culet serve` of its own, with the options that a user's would have. Names choose among the trials.
"""

from __future__ import annotations

import argparse
import asyncio
import platform
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import psutil

from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.device import open_device
from hostile import faults, inputs, shares
from hostile.finding import Finding, Group
from hostile.forms import SHAPES
from hostile.serving import Serving

BEGIN, END = "<!-- table: begin -->", "<!-- table: end -->"
SEED = 1
PAGE = 640, 360
FORMS = dict.fromkeys(SHAPES, 63) | {"chunks of one byte": 1}
"""MiB of each shape. Of chunks, of which there are 175 000 in each, a connection may send 10 000 a second."""
MEMORY = 512
"""MiB that sessions, uploads and pictures may take where that is tried."""
HEAPS = 400
"""MB of an engine with ten sessions of twelve stones each."""
PROGRAMS = 700
"""MiB of the processes themselves, those that stand by among them."""


@dataclass(frozen=True)
class Trial:
    """One or more rows."""

    name: str
    tried: Callable[[Serving], Awaitable[Finding | list[Finding]]]
    group: Group
    options: Sequence[str] = ()
    files: int | None = None
    """That the server may open."""
    environment: Mapping[str, str] = field(default_factory=dict)

    async def run(self) -> list[Finding]:
        """On a server of its own."""
        with Serving(*self.options, environment=self.environment, files=self.files) as serving:
            found = await self.tried(serving)
        return found if isinstance(found, list) else [found]


async def _cache_removed(_: Serving) -> Finding:
    """On a server with a cache of its own, which starts with what is compiled already."""
    with tempfile.TemporaryDirectory(prefix="culet-cache-") as folder:
        cache = Path(folder, "kernels")
        shutil.copytree(kernel_cache.folder(), cache)
        with Serving(environment={"POCL_CACHE_DIR": str(cache)}) as serving:
            return await faults.cache_removed(serving, cache)


def trials(part: float = 1) -> tuple[Trial, ...]:
    """All; with as many inputs and as much chaos as that part of the whole has, which takes an hour."""

    def some(count: int) -> int:
        return max(1, round(part * count))

    def beside(name: str, attack: shares.Attack, keeps: float) -> Callable[[Serving], Awaitable[Finding]]:
        return lambda serving: shares.beside(serving, name, attack, keeps, seconds=max(4, 8 * part))

    return (
        Trial("viewers", lambda s: shares.viewers_of_one_session(s, 30, 10), Group.LOAD),
        Trial("sessions", lambda s: shares.falling_sessions(s, 20, 10, PAGE), Group.LOAD),
        Trial("heaps", lambda s: shares.memory_of_heaps(s, 10, 12, 20, HEAPS), Group.LOAD),
        Trial("dearest scene", beside("a session that asks for everything", shares.dearest_scene, 0.4), Group.SHARES),
        Trial("dearest stills", beside("eight stills of 8192x4096", shares.dearest_stills, 0.4), Group.SHARES),
        Trial("resizes", beside("a flood of `resize`", shares.resizes, 0.8), Group.SHARES),
        Trial("orbits", beside("a flood of `orbit`", shares.orbits, 0.4), Group.SHARES),
        Trial("questions", beside("a flood of `pick` and `outline`", shares.questions, 0.4), Group.SHARES),
        Trial("reaches", beside("a flood of `reach`", shares.reaches, 0.4), Group.SHARES),
        Trial(
            "slow readers",
            lambda s: shares.slow_readers(s, 40, 0.5, 100, 10),
            Group.SHARES,
            ("--max-viewers", "64"),
        ),
        Trial("scatters", beside("a flood of patches of 64 stones", shares.scatters, 0.4), Group.SHARES),
        Trial("half-sent", lambda s: shares.half_sent_requests(s, 1300, within=2), Group.SHARES, files=1024),
        Trial("forms", lambda s: shares.forms(s, FORMS, within=0.05), Group.SHARES),
        Trial("engine killed", lambda s: faults.killed(s, "engine", max(3, some(5)), within=3), Group.FAULTS),
        Trial("gateway killed", lambda s: faults.killed(s, "gateway", max(3, some(5)), within=5), Group.FAULTS),
        Trial("heavy sessions", lambda s: faults.killed_with_heavy_sessions(s, 8, 32), Group.FAULTS),
        Trial("engine hung", lambda s: faults.hung(s, "engine"), Group.FAULTS),
        Trial("gateway hung", lambda s: faults.hung(s, "gateway"), Group.FAULTS),
        Trial("cache removed", _cache_removed, Group.FAULTS),
        Trial(
            "chaos",
            lambda s: faults.chaos(s, 20, 5, max(30, 600 * part), between=min(12, 5 + 60 * part), seed=SEED),
            Group.FAULTS,
        ),
        Trial("messages", lambda s: inputs.control_messages(s, some(10_000), SEED), Group.INPUTS),
        Trial("frames", lambda s: inputs.websocket_frames(s, some(300), SEED), Group.INPUTS),
        Trial("files", lambda s: inputs.mutated_files(s, some(2000), SEED), Group.INPUTS),
        Trial("bombs", lambda s: inputs.bombs(s, (8192, 4096)), Group.INPUTS),
        Trial(
            "skies",
            lambda s: inputs.ever_other_skies(s, max(8, some(28)), MEMORY + PROGRAMS),
            Group.INPUTS,
            ("--memory", f"{MEMORY}MiB"),
        ),
        Trial(
            "interface",
            lambda s: inputs.whole_interface(s, some(50), SEED),
            Group.INPUTS,
            ("--max-still-work", "1e8"),  # stills that take a second or two, not minutes
        ),
    )


def table(found: Sequence[Finding]) -> str:
    """Markdown, a part for each group."""
    parts = []
    for group in Group:
        rows = [finding.row for finding in found if finding.group is group]
        if rows:
            head = f"| {group} | found | wanted | holds |\n|---|---|---|---|\n"
            parts.append(head + "\n".join(rows) + "\n")
    return "\n".join(parts)


def provenance() -> str:
    """Where and of what."""
    git = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    commit = subprocess.run(git, capture_output=True, text=True, check=False).stdout.strip() or "unknown"
    device = open_device()
    load = ", ".join(f"{each:.1f}" for each in psutil.getloadavg())
    return (
        f"Measured on {datetime.now(UTC):%Y-%m-%d} at commit {commit}: {device.name}, {psutil.cpu_count()} cores, "
        f"{psutil.virtual_memory().total / 2**30:.0f} GiB, {device.driver}, Python {platform.python_version()}, Linux "
        f"{platform.release()}. The clients ran on the same machine; load averages at the end, with all other work: "
        f"{load}.\n"
    )


def run(chosen: Sequence[Trial]) -> Iterator[list[Finding]]:
    """All findings so far, after each trial; one that fails altogether is a finding too."""
    found: list[Finding] = []
    for trial in chosen:
        began = time.monotonic()
        try:
            rows = asyncio.run(trial.run())
        except Exception as error:
            traceback.print_exc()
            ended = f"the trial ended: {type(error).__name__}: {error}".splitlines()[0]
            rows = [Finding(trial.group, trial.name, ended, "it comes to its end", False)]
        for row in rows:
            print(f"{trial.name} ({time.monotonic() - began:.0f} s): {row.row}", flush=True)
        found += rows
        yield found


def write(text: str, into: Path) -> None:
    """Between the marks of a document."""
    before, rest = into.read_text().split(BEGIN)
    into.write_text(f"{before}{BEGIN}\n{text}{END}{rest.split(END)[1]}")


def main(arguments: list[str]) -> int:
    """Exit code 1 if something does not hold. What was found before an interruption is written."""
    parser = argparse.ArgumentParser(prog="python -m hostile.reliability")
    parser.add_argument("--into", type=Path, metavar="FILE", help="a document, between whose marks the table goes")
    parser.add_argument("--part", type=float, default=1, help="of the inputs and of the chaos, 0 to 1")
    parser.add_argument("names", nargs="*", metavar="NAME", help="of trials, or what they begin with; without any, all")
    given = parser.parse_args(arguments)
    found: list[Finding] = []
    names = tuple(given.names) or ("",)
    for found in run([trial for trial in trials(given.part) if trial.name.startswith(names)]):
        text = f"{provenance()}\n{table(found)}"
        if given.into:
            write(text, given.into)
    if not given.into:
        print(text)
    return int(not all(finding.holds for finding in found))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
