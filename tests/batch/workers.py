"""Commands whose workers are seen and killed, and what they have made."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

from culet.batch.animation import JOURNAL, Animation

PATIENCE = 300
"""s, for what takes a few on an idle machine."""

Command = subprocess.Popen[str]


def until(done: Callable[[], bool], command: Command) -> None:
    """Wait for it, as long as the command runs."""
    end = time.monotonic() + PATIENCE
    while not done():
        assert time.monotonic() < end, "it took too long"
        assert command.poll() is None, command.communicate()
        time.sleep(0.05)


@contextmanager
def started(*arguments: str | Path) -> Iterator[Command]:
    """A command of culet in a group of processes of its own, as a terminal's; killed with all of them in the end."""
    command = subprocess.Popen(
        [sys.executable, "-m", "culet", *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        yield command
    finally:
        if alive(command):
            others = psutil.Process(command.pid).children(recursive=True)
            command.kill()
            for process in others:
                process.kill()
        command.communicate()


def alive(command: Command) -> bool:
    """Whether it runs."""
    return command.poll() is None


def ended(command: Command) -> tuple[int, str, str]:
    """Its exit code and what it has printed, on both ways."""
    out, err = command.communicate(timeout=PATIENCE)
    return command.returncode, out, err


def line_told(command: Command) -> str:
    """The next one on its way of errors."""
    assert command.stderr is not None
    assert select.select([command.stderr], [], [], PATIENCE)[0], "it told nothing"
    return command.stderr.readline()


def interrupt(command: Command) -> None:
    """Ctrl-C: the terminal tells the whole group."""
    os.killpg(command.pid, signal.SIGINT)


def workers_of(command: Command) -> list[psutil.Process]:
    """The processes that multiprocessing has started for it."""
    found = psutil.Process(command.pid).children(recursive=True)
    return [process for process in found if any("spawn_main" in word for word in _words(process))]


def _words(process: psutil.Process) -> list[str]:
    """Of its command; none of one that has ended meanwhile, whether or not somebody knows already."""
    try:
        return process.cmdline()
    except psutil.NoSuchProcess:
        return []


def numbers_in(folder: Path) -> list[int]:
    """Of the frames that the journal has, in the order in which they came."""
    journal = folder / JOURNAL
    lines = journal.read_text().splitlines(keepends=True)[1:] if journal.exists() else []
    return [json.loads(line)["frame"] for line in lines if line.endswith("\n")]


def check_frames(animation: Animation, folder: Path, numbers: list[int]) -> None:
    """The files of those frames are what this process makes of them."""
    task = animation.task()
    for number in numbers:
        made = task((number, animation.stages[number].scene))
        assert animation.file(folder, number).read_bytes() == made.data, number
