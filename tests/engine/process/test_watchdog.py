"""An engine that stands still ends itself, with a word about where it stands; one that compiles is given time."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import asyncio, threading, time
from concurrent.futures import ThreadPoolExecutor
from culet.engine.process import watchdog
from culet.rendering.compiling import compiling

watchdog.HANG_SECONDS, watchdog.COMPILER_SECONDS, watchdog.BEAT_SECONDS = 0.4, 600, 0.05
stuck = threading.Event()

def hang():
    stuck.wait()

def compile_for_long():
    with compiling():
        time.sleep(1)

async def main():
    threads = ThreadPoolExecutor(1)
    running = asyncio.create_task(watchdog.Watchdog(threads).run())
    await asyncio.sleep(0.2)
    {happens}
    await asyncio.sleep(0.8)
    print("alive")
    running.cancel()
    await asyncio.gather(running, return_exceptions=True)
    time.sleep(1)
    print("and not watched any more")

asyncio.run(main())
"""


def run(happens: str) -> subprocess.CompletedProcess[str]:
    """A process in which that happens."""
    command = [sys.executable, "-c", SCRIPT.replace("{happens}", happens)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("happens", ["threads.submit(hang)", "hang()"], ids=["render-thread", "loop"])
def test_an_engine_whose_thread_or_loop_hangs_ends_and_says_where(happens: str) -> None:
    done = run(happens)
    assert done.returncode == 1
    assert "alive" not in done.stdout
    assert "Timeout" in done.stderr
    assert " in hang" in done.stderr


@pytest.mark.parametrize(
    "happens", ["pass", "await asyncio.wrap_future(threads.submit(compile_for_long))"], ids=["idle", "compiling"]
)
def test_an_engine_that_works_lives(happens: str) -> None:
    done = run(happens)
    assert (done.returncode, done.stdout, done.stderr) == (0, "alive\nand not watched any more\n", "")
