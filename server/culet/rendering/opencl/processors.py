"""How many processors this process may use: PoCL starts a thread for each that the machine has, whatever it may use."""

from __future__ import annotations

import logging
import math
import os
from pathlib import Path

log = logging.getLogger(__name__)

GROUPS = Path("/sys/fs/cgroup")
OWN_GROUP = Path("/proc/self/cgroup")
THREADS = "POCL_MAX_PTHREAD_COUNT", "POCL_CPU_MAX_CU_COUNT"
"""PoCL's variables: 3.1 heeds the first one alone, 6 both. Read when the driver is loaded."""


def quota(groups: Path = GROUPS, own: Path = OWN_GROUP) -> float:
    """Processors' worth of time that the control groups of this process allow (cgroups(7), version 2); infinite without
    a limit. A group is limited by those that it lies in, too."""
    try:
        path = next(line for line in own.read_text().splitlines() if line.startswith("0::")).removeprefix("0::")
    except (OSError, StopIteration):
        return math.inf
    found, group = math.inf, groups / path.strip("/")
    while True:
        try:
            most, period = (group / "cpu.max").read_text().split()
            if most != "max":
                found = min(found, float(most) / float(period))
        except (OSError, ValueError, ZeroDivisionError):
            pass  # the root has no such file
        if group in (groups, group.parent):
            return found
        group = group.parent


def usable(limit: float) -> int:
    """Whole processors, by the process's affinity and a quota; more threads than that would wait for each other."""
    affinity = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, min(affinity, math.ceil(limit) if math.isfinite(limit) else affinity))


def limit_threads() -> None:
    """Have PoCL, which is not loaded yet, start so many threads, unless the environment says how many."""
    there, count = os.cpu_count() or 1, usable(quota())
    if any(os.environ.get(name) for name in THREADS) or count >= there:
        return
    log.info("rendering with %d of %d processors: more are not this process's to use", count, there)
    for name in THREADS:
        os.environ[name] = str(count)


def limit_threads_to(count: int) -> None:
    """Have PoCL, which is not loaded yet, start so many threads, unless the environment says how many."""
    for name in THREADS:
        os.environ.setdefault(name, str(count))
