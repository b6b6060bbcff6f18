"""Which package brings an OpenCL driver for the processor, where culet runs."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Mapping

BY_SYSTEM: Mapping[str, str] = {
    "debian": "apt-get install pocl-opencl-icd",
    "fedora": "dnf install pocl",
    "macos": "brew install pocl",
    "conda": "conda install conda-forge::pocl",
}
"""PoCL, by the names that systems give themselves (os-release: ID, or what it is like)."""


def how_to_install() -> str:
    """The command for this system, or for each that is known if this one is not."""
    for system in _systems():
        if (command := BY_SYSTEM.get(system)) is not None:
            return command
    return "; ".join(f"{system.capitalize()}: {command}" for system, command in BY_SYSTEM.items())


def _systems() -> list[str]:
    """What this system is called, the nearest name first."""
    found = ["conda"] if os.environ.get("CONDA_PREFIX") else []
    if sys.platform == "darwin":
        return [*found, "macos"]
    try:
        release = platform.freedesktop_os_release()
    except OSError:
        return found
    return [*found, release.get("ID", ""), *release.get("ID_LIKE", "").split()]
