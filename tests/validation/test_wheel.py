"""The wheel by itself: built, installed where nothing of the checkout is, served, and its page looked at."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import venv
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

from culet.simulation.solver.build import library_name
from shared import patience

REPOSITORY = Path(__file__).parents[2]
PAGE = REPOSITORY / "client" / "web" / "dist" / "index.html"
PATIENCE = patience.PATIENCE
ARGUMENTS = ("--no-sandbox", "--disable-gpu", "--disable-background-networking")

pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(not PAGE.is_file(), reason="the page is not built: make wheel"),
]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As `make wheel` builds it."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--no-deps",
        "--wheel-dir",
        str(folder),
        str(REPOSITORY),
    ]
    subprocess.run(command, check=True)
    (built,) = folder.glob("culet-*.whl")
    return built


@pytest.fixture(scope="module")
def culet(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command, in an environment that has nothing but the wheel and what it asks for."""
    folder = tmp_path_factory.mktemp("clean")
    venv.create(folder)
    python = str(folder / "bin" / "python")
    pip = [sys.executable, "-m", "pip", "--python", python]  # which need not be installed there itself
    subprocess.run([*pip, "install", "--quiet", "--no-compile", str(wheel)], check=True)
    return folder / "bin" / "culet"


@pytest.fixture
def served(culet: Path, tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """The URL that `culet serve` prints in a folder of its own, and its messages."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "CULET_"))}
    messages = tmp_path / "messages"
    with messages.open("wb") as errors:
        server = subprocess.Popen(
            [culet, "serve", "--port", "0"], cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=errors
        )
    assert server.stdout is not None
    try:
        line = server.stdout.readline().decode()
        assert line.startswith("culet is ready: "), messages.read_text()
        yield line.removeprefix("culet is ready: ").strip(), messages
    finally:
        server.terminate()
        server.stdout.close()
        server.wait(PATIENCE)


def test_the_wheel_holds_the_built_page_and_the_small_pictures_of_the_scenes(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        page = archive.read("culet/page/index.html")
    assert page == PAGE.read_bytes()
    assert {name.rpartition(".")[2] for name in names if name.startswith("culet/page/assets/")} >= {"js", "css"}
    assert "culet/scene/thumbnails/default.webp" in names
    assert not [name for name in names if "node_modules" in name]


def test_the_wheel_holds_the_solver_of_several_stones_and_is_of_this_kind_of_machine(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert f"culet/simulation/solver/{library_name()}" in names
    assert wheel.name.endswith(f"-py3-none-linux_{platform.machine()}.whl")


def test_an_installed_wheel_moves_several_stones_without_a_compiler(culet: Path, tmp_path: Path) -> None:
    program = (
        "from culet.simulation.solver.library import SOURCES, library\n"
        "from culet.study.contacts.heaps import heap\n"
        "heap(2, 1).step()\n"
        "assert library()._name.startswith(str(SOURCES))\n"
    )
    environment = {"PATH": str(tmp_path), "HOME": str(tmp_path)}
    subprocess.run([culet.parent / "python", "-c", program], cwd=tmp_path, env=environment, check=True)


def test_an_installed_wheel_serves_its_page_and_a_picture(served: tuple[str, Path]) -> None:
    url, messages = served
    executable = os.environ.get("CULET_CHROMIUM") or shutil.which("chromium")
    assert executable, "there is no chromium on the PATH; name one by CULET_CHROMIUM"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 480, "height": 500})
        page.goto(url)
        page.wait_for_function("() => window.culet && culet.framesShown > 0", timeout=PATIENCE * 1000)
        page.wait_for_function("() => document.querySelector('#scenes img')?.naturalWidth > 0")
        assert page.evaluate("() => culet.problems") == []
        browser.close()
    assert "no page" not in messages.read_text()
