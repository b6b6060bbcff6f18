"""Why no device works, in words that help."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


def complaint(**environment: str) -> str:
    """Of a process of its own: a driver looks at its environment once."""
    without = {name: value for name, value in os.environ.items() if not name.startswith(("POCL_", "XDG_", "CULET_"))}
    opened = "from culet.rendering.device import open_device; open_device()"
    done = subprocess.run(
        [sys.executable, "-c", opened], env=without | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    return done.stderr.strip().rpartition("\n")[2]


@pytest.mark.parametrize(
    ("environment", "folder"),
    [
        ({"XDG_CACHE_HOME": "/proc/none"}, "/proc/none/pocl/kcache"),
        ({"POCL_CACHE_DIR": "/proc/none"}, "/proc/none"),
        ({"HOME": "/proc/none"}, "/proc/none/.cache/pocl/kcache"),
    ],
)
def test_a_cache_that_cannot_be_written_is_named_as_the_cause(environment: dict[str, str], folder: str) -> None:
    found = complaint(**environment)
    assert "no OpenCL device works" in found
    assert f"PoCL cannot write to its cache {folder} (No such file or directory)" in found
    assert "POCL_CACHE_DIR" in found


def test_a_device_that_is_not_there_is_named() -> None:
    assert "none matches CULET_DEVICE='abacus'" in complaint(CULET_DEVICE="abacus")
