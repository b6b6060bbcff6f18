"""The memory that a process may take, as the system tells it, by folders like its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from culet.engine.capacity.machine import SHARE, budget, memory_of_machine

GIBIBYTE = 2**30
MACHINE = {"proc/meminfo": "MemTotal:       16777216 kB\nMemFree: 1 kB\n"}

CASES = {
    "no control groups": ({}, 16),
    "version 2, within a container": (
        {"proc/self/cgroup": "0::/\n", "sys/fs/cgroup/memory.max": f"{3 * GIBIBYTE}\n"},
        3,
    ),
    "version 2, a service whose slice has the limit": (
        {
            "proc/self/cgroup": "0::/demo.slice/culet.service\n",
            "sys/fs/cgroup/demo.slice/culet.service/memory.max": "max\n",
            "sys/fs/cgroup/demo.slice/memory.max": f"{2 * GIBIBYTE}\n",
        },
        2,
    ),
    "version 1, within a container that sees its group as the root": (
        {
            "proc/self/cgroup": "7:cpu:/x\n4:memory:/docker/abc\n0::/\n",
            "sys/fs/cgroup/memory/memory.limit_in_bytes": f"{5 * GIBIBYTE}\n",
        },
        5,
    ),
    "version 1, no limit": (
        {"proc/self/cgroup": "4:memory:/\n", "sys/fs/cgroup/memory/memory.limit_in_bytes": "9223372036854771712\n"},
        16,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_least_of_machine_and_groups_counts(case: str, tmp_path: Path) -> None:
    files, gibibytes = CASES[case]
    for name, content in {**MACHINE, **files}.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    assert memory_of_machine(tmp_path) == gibibytes * GIBIBYTE
    assert budget(None, tmp_path) == int(SHARE * gibibytes * GIBIBYTE)


def test_a_system_that_does_not_say_gets_a_small_budget(tmp_path: Path) -> None:
    assert memory_of_machine(tmp_path) == 2 * GIBIBYTE


@pytest.mark.parametrize(("asked", "warned"), [(2, False), (3, True), (4, True)])
def test_a_budget_that_the_container_does_not_have_is_warned_of(
    asked: int, warned: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    limit = tmp_path / "sys/fs/cgroup/memory.max"
    limit.parent.mkdir(parents=True)
    limit.write_text(f"{3 * GIBIBYTE}\n")
    assert budget(asked * GIBIBYTE, tmp_path) == asked * GIBIBYTE
    assert ("3072 MiB" in caplog.text) is warned
