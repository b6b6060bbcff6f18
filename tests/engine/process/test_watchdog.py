"""An engine that stands still ends itself, with a word about where it stands; one that compiles is given time."""

from __future__ import annotations

import asyncio
import faulthandler
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from culet.engine.process import watchdog
from culet.rendering.opencl.compiling import compiling
from gateway.running import eventually
from shared.patience import PATIENCE

SCRIPT = """
import asyncio, threading
from concurrent.futures import ThreadPoolExecutor
from culet.engine.process import watchdog

watchdog.HANG_SECONDS, watchdog.BEAT_SECONDS = 2, 0.05
stuck = threading.Event()

def hang():
    stuck.wait()

async def main():
    threads = ThreadPoolExecutor(1)
    running = asyncio.create_task(watchdog.Watchdog(threads).run())
    await asyncio.sleep(0)
    {happens}
    await running

asyncio.run(main())
"""


@pytest.mark.parametrize("happens", ["threads.submit(hang)", "hang()"], ids=["render-thread", "loop"])
def test_an_engine_whose_thread_or_loop_hangs_ends_and_says_where(happens: str) -> None:
    command = [sys.executable, "-c", SCRIPT.replace("{happens}", happens)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 1
    assert "Timeout" in done.stderr
    assert " in hang" in done.stderr


async def test_an_engine_that_compiles_is_given_a_compilers_time_and_one_that_ends_is_not_watched_any_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By what faulthandler is told: after how many seconds it is to end the process, and to leave it alone (0)."""
    told: list[float] = []
    monkeypatch.setattr(faulthandler, "dump_traceback_later", lambda seconds, **_: told.append(seconds))
    monkeypatch.setattr(faulthandler, "cancel_dump_traceback_later", lambda: told.append(0))
    monkeypatch.setattr(watchdog, "BEAT_SECONDS", 0.001)
    compiles, compiled = threading.Event(), threading.Event()

    def compile_for_long() -> None:
        with compiling():
            compiles.set()
            assert compiled.wait(PATIENCE)

    async def beats(seconds: float) -> None:
        """Until it was told of that time twice more, one after the other."""
        before = len(told)

        async def twice() -> bool:
            return len(told) >= before + 2 and told[-2:] == [seconds] * 2

        await eventually(twice)

    with ThreadPoolExecutor(1) as threads, ThreadPoolExecutor(1) as compiler:
        running = asyncio.create_task(watchdog.Watchdog(threads).run())
        await beats(watchdog.HANG_SECONDS)
        compilation = compiler.submit(compile_for_long)
        assert await asyncio.to_thread(compiles.wait, PATIENCE)
        await beats(watchdog.COMPILER_SECONDS)
        compiled.set()
        await asyncio.wrap_future(compilation)
        await beats(watchdog.HANG_SECONDS)
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
    told_before = len(told)
    with compiling():
        pass
    assert (told[-1], len(told)) == (0, told_before)
