"""`culet` as a user has it: its output and its exit code."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from typer.testing import CliRunner

from culet.cli import app

PATIENCE = 300
"""s for a command to end, compiling included; none under test takes a tenth of that on an idle machine."""

Run = subprocess.CompletedProcess[str]


def culet(*arguments: str | Path, stdin: str = "") -> Run:
    """A process: what is seen of a command only when Python starts, and ends, with it."""
    return subprocess.run(
        [sys.executable, "-m", "culet", *arguments],
        input=stdin, capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip


def invoke(*arguments: str | Path, stdin: str = "") -> Run:
    """The same in this process, which has imported all that the command needs: a start costs 0.3 s of processor time.

    An exception that would end in a traceback is raised.
    """
    words = [str(argument) for argument in arguments]
    result = CliRunner().invoke(app, words, input=stdin, prog_name="culet", catch_exceptions=False)
    return subprocess.CompletedProcess(words, result.exit_code, result.stdout, result.stderr)
