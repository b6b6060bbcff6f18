"""What each part may not load: the gateway no device, the engine no web server, the clients nothing of the server."""

from __future__ import annotations

import subprocess
import sys

import pytest

NOT_LOADED = {
    "culet.gateway.serve": ("pyopencl", "culet.rendering", "culet.engine"),
    "culet.service.serve": ("pyopencl", "culet.rendering", "culet.engine", "fastapi", "uvicorn"),
    "culet.engine.process.serve": ("fastapi", "uvicorn"),
    "culet.engine.library.upload_reader": ("pyopencl",),
    "culet_client.view": ("culet", "pyopencl", "numpy", "fastapi"),
    "culet_client.stream": ("culet", "pyopencl", "numpy", "fastapi"),
}
"""Module -> packages that importing it leaves alone."""


@pytest.mark.parametrize("module", NOT_LOADED)
def test_a_part_does_not_load_what_belongs_to_another(module: str) -> None:
    run = subprocess.run(
        [sys.executable, "-c", f"import sys, {module}; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    loaded = run.stdout.split()
    assert module in loaded
    assert [name for name in loaded if f"{name}.".startswith(tuple(f"{each}." for each in NOT_LOADED[module]))] == []
