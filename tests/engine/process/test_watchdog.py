"""An engine that stands still ends itself, with a word about where it stands; one that compiles is given time."""

from __future__ import annotations

import subprocess
import sys

import pytest

from shared.patience import PATIENCE

SCRIPT = """
import asyncio, sys, threading, time
from concurrent.futures import ThreadPoolExecutor
from culet.engine.process import watchdog
from culet.rendering.compiling import compiling

seconds, alive_seconds = map(float, sys.argv[1:])
watchdog.HANG_SECONDS, watchdog.COMPILER_SECONDS, watchdog.BEAT_SECONDS = seconds, 600, 0.05
stuck = threading.Event()

def hang():
    stuck.wait()

def compile_for_long():
    with compiling():
        time.sleep(1.3 * seconds)

async def main():
    threads = ThreadPoolExecutor(1)
    running = asyncio.create_task(watchdog.Watchdog(threads).run())
    await asyncio.sleep(0)
    {happens}
    await asyncio.sleep(alive_seconds)
    print("alive")
    running.cancel()
    await asyncio.gather(running, return_exceptions=True)
    time.sleep(1.3 * seconds)
    print("and not watched any more")

asyncio.run(main())
"""


def run(happens: str, hang_seconds: float, alive_seconds: float) -> subprocess.CompletedProcess[str]:
    """A process in which that happens, which counts as hung after so long, and says after so long that it is alive."""
    command = [sys.executable, "-c", SCRIPT.replace("{happens}", happens), str(hang_seconds), str(alive_seconds)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)


@pytest.mark.parametrize("happens", ["threads.submit(hang)", "hang()"], ids=["render-thread", "loop"])
def test_an_engine_whose_thread_or_loop_hangs_ends_and_says_where(happens: str) -> None:
    done = run(happens, 1, PATIENCE)
    assert done.returncode == 1
    assert "alive" not in done.stdout
    assert "Timeout" in done.stderr
    assert " in hang" in done.stderr


def test_an_engine_that_compiles_or_has_nothing_to_do_lives() -> None:
    """Counted as hung after what this process never stands still for, however much else goes on."""
    done = run("await asyncio.wrap_future(threads.submit(compile_for_long))", 2, 2.6)
    assert (done.returncode, done.stdout, done.stderr) == (0, "alive\nand not watched any more\n", "")
