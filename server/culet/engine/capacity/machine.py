"""How much memory there is for this process: the machine's, or less if a container or a service has a limit."""

from __future__ import annotations

import contextlib
import logging
from pathlib import Path

log = logging.getLogger(__name__)

SHARE = 0.5
"""Of the memory there is that the engine takes unless told otherwise: the gateway, the readers' programs and the
compiled kernels need some, and so may others."""
ASSUMED = 2**31
"""Bytes, on a system that does not say."""


def memory_of_machine(root: Path = Path("/")) -> int:
    """Bytes, the least of what the system has and what control groups allow, of version 1 or 2."""
    allowed = [_total(root / "proc/meminfo"), *_limits(root)]
    return min((size for size in allowed if size > 0), default=ASSUMED)


def budget(asked: int | None, root: Path = Path("/")) -> int:
    """Bytes that the engine's sessions, uploads and pictures may take: those asked for, or a share of what there is.

    More than there is gets a warning, since the system would end the engine before its budget is used up.
    """
    there_is = memory_of_machine(root)
    if asked is None:
        return int(SHARE * there_is)
    if asked >= there_is:
        log.warning(
            "the memory asked for, %.0f MiB, is not less than the %.0f MiB that this machine or container has: the "
            "engine may be ended for taking too much; by default it takes half",
            asked / 2**20,
            there_is / 2**20,
        )
    return asked


def _total(meminfo: Path) -> int:
    with contextlib.suppress(OSError, ValueError, IndexError):
        for line in meminfo.read_text(encoding="ascii").splitlines():
            if line.startswith("MemTotal:"):
                return int(line.split()[1]) * 1024
    return 0


def _limits(root: Path) -> list[int]:
    """Of the process's control groups and all above them. Within a container a group's own folder may not be there: it
    is mounted as the root of what is seen."""
    try:
        groups = (root / "proc/self/cgroup").read_text(encoding="utf-8").splitlines()
    except OSError:
        groups = ["0::/"]
    found = []
    for group in groups:
        _, controllers, path = (*group.split(":", 2), "", "")[:3]
        if controllers == "":
            found += _up_from(root / "sys/fs/cgroup", path, "memory.max")
            found += _up_from(root / "sys/fs/cgroup/unified", path, "memory.max")
        elif "memory" in controllers.split(","):
            found += _up_from(root / "sys/fs/cgroup/memory", path, "memory.limit_in_bytes")
    return found


def _up_from(mount: Path, path: str, name: str) -> list[int]:
    folder, found = mount / path.lstrip("/"), []
    for place in [folder, *folder.parents]:
        with contextlib.suppress(OSError, ValueError):  # none there, or "max"
            found.append(int((place / name).read_text(encoding="ascii")))
        if place == mount:
            break
    return found
