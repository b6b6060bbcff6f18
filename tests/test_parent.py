"""A process that asked for it ends when its parent does."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

from shared.patience import PATIENCE

CHILD = """
import os, time
from culet.parent import ending_with
ending_with({parent})()
print(os.getpid(), flush=True)
time.sleep(60)
"""
PARENT = """
import os, subprocess, sys
child = sys.argv[1].replace("{parent}", str(os.getpid() + int(sys.argv[2])))
running = subprocess.Popen([sys.executable, "-c", child], stdout=subprocess.PIPE, text=True)
print(running.stdout.readline().strip(), flush=True)
os._exit(0)
"""


def child_of(parent_off_by: int) -> str:
    """What a child said once it had asked: its process id, or nothing if it ended at once."""
    command = [sys.executable, "-c", PARENT, CHILD, str(parent_off_by)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True).stdout.strip()


def lives(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_it_is_killed_when_its_parent_ends() -> None:
    child = int(child_of(0))
    deadline = time.monotonic() + PATIENCE
    while lives(child):
        assert time.monotonic() < deadline, "it outlived its parent"


def test_it_ends_at_once_if_its_parent_has_ended_before() -> None:
    assert child_of(1) == ""
