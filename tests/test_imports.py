"""What each part may not load: the gateway no device, the engine no web server, the clients nothing of the server."""

from __future__ import annotations

import ast
import importlib.metadata
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

NOT_LOADED = {
    "culet.gateway.serve": ("pyopencl", "culet.rendering", "culet.engine"),
    "culet.service.serve": ("pyopencl", "culet.rendering", "culet.engine", "fastapi", "uvicorn"),
    "culet.engine.serve": ("fastapi", "uvicorn"),
    "culet.engine.upload_reader": ("pyopencl",),
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


ROOT = Path(__file__).parents[1]
PACKAGES = ("server/culet", "kernels/culet_kernels", "protocol/culet_protocol", "client/culet_client")
STUDY = "server/culet/study"
"""What it imports may be declared for it alone."""


def imported(folder: Path) -> Iterator[tuple[str, Path]]:
    """Packages that files there name, each with a file that does."""
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                yield from ((alias.name.partition(".")[0], path) for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                yield node.module.partition(".")[0], path


def declared(requirements: list[str]) -> set[str]:
    """Names of distributions, as the index writes them."""
    return {re.sub(r"[-_.]+", "-", re.split(r"[^\w.-]", each, maxsplit=1)[0]).lower() for each in requirements}


def test_whatever_is_imported_is_declared() -> None:
    """Another package may need it today, and not tomorrow."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    always = declared(project["dependencies"])
    for_studies = always | declared(project["optional-dependencies"]["study"] + ["mitsuba"])
    own = {package.rpartition("/")[2] for package in PACKAGES} | set(sys.stdlib_module_names)
    distributions = importlib.metadata.packages_distributions()
    missing = set()
    for package in PACKAGES:
        for name, path in imported(ROOT / package):
            allowed = for_studies if path.is_relative_to(ROOT / STUDY) else always
            providers = declared(distributions.get(name, [name]))
            if name not in own and not providers & allowed:
                missing.add((name, str(path.relative_to(ROOT))))
    assert missing == set()
