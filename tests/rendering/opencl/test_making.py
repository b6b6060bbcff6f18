"""Processes that want one program at the same time."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from culet.rendering.opencl.making import alone, lacks
from shared import patience

PATIENCE = patience.PATIENCE
MAKE = """
import time
from culet.rendering.opencl.device import open_device
from culet.rendering.features import Features, Geometry
from culet.rendering.programs.build import Variant
from culet.rendering.programs.program import Programs
programs = Programs(open_device())
began = time.process_time()
programs.exact(Features(Geometry.EMPTY), Variant(lanes=4))
print(time.process_time() - began)
"""


def test_who_wants_a_program_that_another_makes_waits_for_it(tmp_path: Path) -> None:
    entered = threading.Event()

    def enter() -> None:
        with alone(tmp_path, "program"):
            entered.set()

    with alone(tmp_path, "program"):
        other = threading.Thread(target=enter)
        other.start()
        with alone(tmp_path, "another program"):
            assert not entered.wait(0.1), "two of one program"
    assert entered.wait(PATIENCE)
    other.join()


def test_a_cache_that_cannot_be_written_keeps_nobody_waiting() -> None:
    with alone(Path("/proc/none"), "program"), alone(Path("/proc/none"), "program"):
        pass


def test_processes_that_start_together_share_one_compilation(tmp_path: Path) -> None:
    environment = os.environ | {"POCL_CACHE_DIR": str(tmp_path)}
    makers = [
        subprocess.Popen([sys.executable, "-c", MAKE], env=environment, stdout=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    seconds = sorted(float(maker.communicate(timeout=PATIENCE)[0]) for maker in makers)
    assert seconds[1] < 0.5 * seconds[2], "of processor time; measured 0.03: two of three read what one has made"


def test_a_program_is_known_to_be_in_the_cache_once_it_is_made(tmp_path: Path) -> None:
    assert lacks(tmp_path, "program")
    with pytest.raises(ZeroDivisionError), alone(tmp_path, "program"):
        raise ZeroDivisionError
    assert lacks(tmp_path, "program"), "it failed"
    with alone(tmp_path, "program"):
        assert lacks(tmp_path, "program")
    assert not lacks(tmp_path, "program")
    assert lacks(tmp_path, "another program")
    assert lacks(tmp_path / "not there yet", "program")


def test_no_other_process_is_asked_where_it_could_not_leave_a_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not lacks(Path("/proc/none"), "program")
    monkeypatch.setenv("POCL_KERNEL_CACHE", "0")
    assert not lacks(tmp_path, "program")
