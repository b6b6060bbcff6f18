"""NumPy's linear algebra keeps out of the way of what renders."""

from __future__ import annotations

import os
import subprocess
import sys

ENGINE = """
import os, sys, types
serve = types.ModuleType("culet.engine.process.serve")
serve.run = lambda *_, **__: print(os.environ.get("OPENBLAS_NUM_THREADS"), "numpy" in sys.modules)
sys.modules[serve.__name__] = serve
from culet.cli import app
app(["engine", "--control", "ipc:///tmp/none", "--frames", "ipc:///tmp/none-either"])
"""


def told(threads: str | None) -> list[str]:
    """What an engine finds that is about to be imported."""
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    if threads is not None:
        environment["OPENBLAS_NUM_THREADS"] = threads
    run = subprocess.run([sys.executable, "-c", ENGINE], env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout.split()


def test_an_engine_has_one_thread_of_it_from_before_numpy_is_imported() -> None:
    assert told(None) == ["1", "False"]


def test_unless_somebody_wants_others() -> None:
    assert told("3") == ["3", "False"]
