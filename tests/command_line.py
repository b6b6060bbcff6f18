"""`culet` as a user has it: a process, its output and its exit code."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

PATIENCE = 300
"""s for a command to end, compiling included; none under test takes a tenth of that on an idle machine."""


def culet(*arguments: str | Path, stdin: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "culet", *arguments],
        input=stdin, capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip
