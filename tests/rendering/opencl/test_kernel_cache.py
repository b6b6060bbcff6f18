"""The folder of compiled programs: gone, full, or not to be written."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from culet.errors import KernelCacheError
from culet.rendering.features import Features
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.device import open_device
from culet.rendering.programs import precompile, program
from culet.rendering.programs.build import Variant
from culet.rendering.programs.program import Programs
from shared.patience import PATIENCE

REMOVED = """
import shutil, sys
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.device import open_device
from culet.rendering.features import Features, Geometry
from culet.rendering.programs.build import Variant
from culet.rendering.programs.program import Programs
device = open_device()
shutil.rmtree(kernel_cache.folder())
Programs(device).exact(Features(geometry=Geometry.EMPTY), Variant())
print(kernel_cache.folder().is_dir())
"""


def test_a_folder_that_was_removed_while_running_is_made_again(tmp_path: Path) -> None:
    """In a process of its own, since PoCL looks for its folder once."""
    environment = os.environ | {"POCL_CACHE_DIR": str(tmp_path / "kernels")}
    done = subprocess.run([sys.executable, "-c", REMOVED], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "True\n"), done.stderr
    assert "was missing, and was made" in done.stderr


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A folder on a disk that is full."""

    def no_space(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setenv("POCL_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(os, "posix_fallocate", no_space)
    monkeypatch.setattr(kernel_cache, "PLENTY_BYTES", 2**62)
    return tmp_path


def test_a_full_disk_is_named(full: Path) -> None:
    assert (kernel_cache.complaint() or "").startswith(f"no space left in {full}, where PoCL keeps")


def test_without_room_a_program_is_refused_and_the_compiler_cannot_end_this_process(
    full: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The compiler's own process ends as LLVM ends it."""
    monkeypatch.setattr(precompile, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    with pytest.raises(KernelCacheError, match=f"no space left in {full}") as refused:
        Programs(open_device()).exact(Features(), Variant())
    assert refused.value.status == 503


def test_the_general_program_serves_until_there_is_room_again(monkeypatch: pytest.MonkeyPatch) -> None:
    programs, variant, special = Programs(open_device()), Variant(), Features(fresnel=0)
    general = programs.exact(special.general, variant)
    asked: list[Features] = []

    def refuse(features: Features, _variant: Variant, *, urgent: bool) -> bool:
        assert not urgent, "frames come first"
        asked.append(features)
        raise KernelCacheError("no space left")

    monkeypatch.setattr(program, "precompile", refuse)
    monkeypatch.setattr(program, "is_uncached", lambda *_program: True)
    monkeypatch.setattr(program, "RETRY_SECONDS", 0)
    deadline = time.monotonic() + PATIENCE
    while len(asked) < 3:
        assert programs.best(special, variant) is general
        assert time.monotonic() < deadline, "it was not tried again"
    assert set(asked) == {special}
