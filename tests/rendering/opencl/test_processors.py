"""PoCL has as many threads as this process may use, by its affinity and by the quota of its control groups."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from culet.rendering.opencl import processors

UNITS = """
import logging, os
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
logging.basicConfig(level="INFO", format="%(message)s")
from culet.rendering.opencl.device import open_device
print(open_device().units)
"""


def test_the_narrowest_of_the_groups_counts(tmp_path: Path) -> None:
    inner = tmp_path / "groups" / "unit" / "inner"
    inner.mkdir(parents=True)
    own = tmp_path / "cgroup"
    own.write_text("1:name=systemd:/elsewhere\n0::/unit/inner\n")
    assert processors.quota(tmp_path / "groups", own) == math.inf, "no group says anything"
    (inner / "cpu.max").write_text("max 100000\n")
    assert processors.quota(tmp_path / "groups", own) == math.inf
    (inner.parent / "cpu.max").write_text("150000 100000\n")
    assert processors.quota(tmp_path / "groups", own) == 1.5
    (inner / "cpu.max").write_text("50000 100000\n")
    assert processors.quota(tmp_path / "groups", own) == 0.5
    own.write_text("0::/\n")  # as a container sees itself
    (tmp_path / "groups" / "cpu.max").write_text("200000 100000\n")
    assert processors.quota(tmp_path / "groups", own) == 2
    assert processors.quota(tmp_path / "groups", tmp_path / "nowhere") == math.inf


def test_a_part_of_a_processor_is_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2, 3})
    assert [processors.usable(limit) for limit in (0.5, 1.5, 2, 16, math.inf)] == [1, 2, 2, 4, 4]


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="the machine has one processor")
def test_a_process_of_one_processor_renders_with_one_and_says_so() -> None:
    ran = subprocess.run([sys.executable, "-c", UNITS], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["1"]
    assert f"rendering with 1 of {os.cpu_count()} processors" in ran.stderr
