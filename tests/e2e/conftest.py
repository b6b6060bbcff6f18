"""A real browser before the real server: one Chromium and one `culet serve` for this folder, for each test new pages.

For the folder, and not for a whole run: the browser's event loop occupies the main thread while it is open, where the
asynchronous tests of other folders need theirs. `tests/conftest.py` hands the folder to one worker as a whole.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, expect, sync_playwright

from e2e.server import PATIENCE, Server
from e2e.view import View

REPOSITORY = Path(__file__).parents[2]
WEB = REPOSITORY / "client" / "web"
SMALL = {"width": 384, "height": 216}
"""Pixels of most pages here: enough to see every change, finished in a fraction of a second."""

WITH_PANEL = {"width": 640, "height": 240}
"""Pixels of the smallest page on which the panel is open."""

BESIDE_PANEL = {"width": 350, "height": 240}
"""Pixels of the picture there: what the panel leaves."""

ARGUMENTS = (
    "--no-sandbox",  # which containers do not allow it to set up
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    # A shop on the internet, which a test makes up, has no other server here than one of this machine.
    "--disable-features=LocalNetworkAccessChecks,BlockInsecurePrivateNetworkRequests",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)

ViewOf = Callable[..., View]


@pytest.fixture(scope="session")
def built_client() -> None:
    """The web client's build, made if there is none or a source is newer."""
    folders = (WEB / "src", WEB / "element", REPOSITORY / "protocol" / "typescript")
    sources = [file for folder in folders for file in folder.rglob("*") if file.is_file()]
    sources += [
        WEB / name
        for name in ("index.html", "package-lock.json", "tsconfig.json", "vite.config.ts", "vite.element.config.ts")
    ]
    built = WEB / "dist" / "index.html"
    if built.exists() and built.stat().st_mtime >= max(source.stat().st_mtime for source in sources):
        return
    node = REPOSITORY / ".venv" / "node" / "bin"  # there if the system's Node.js is too old
    environment = os.environ | {"PATH": f"{node}{os.pathsep}{os.environ['PATH']}"}
    if not (WEB / "node_modules").exists():
        subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=WEB, env=environment, check=True)
    subprocess.run(["npm", "run", "build"], cwd=WEB, env=environment, check=True)


@pytest.fixture(scope="package")
def server(built_client: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """`culet serve`, ready."""
    with Server(tmp_path_factory.mktemp("serve")) as running:
        yield running


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium without a network: it can resolve no name, and reach nothing but this machine."""
    executable = os.environ.get("CULET_CHROMIUM") or shutil.which("chromium")
    assert executable, "there is no chromium on the PATH; name one by CULET_CHROMIUM"
    expect.set_options(timeout=PATIENCE * 1e3)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=executable, args=ARGUMENTS)
        yield chromium
        chromium.close()


@pytest.fixture
def view_of(browser: Browser, server: Server) -> Iterator[ViewOf]:
    """Makes pages as of separate visitors. None may complain in its console, or ask another host for anything."""
    views: list[View] = []

    def new_view(**options: Any) -> View:  # noqa: ANN401 - those of Browser.new_context
        context = browser.new_context(**({"viewport": SMALL} | options))
        views.append(View(context.new_page(), server))
        return views[-1]

    yield new_view
    sessions = {session for view in views for session in parse_qs(urlsplit(view.page.url).query).get("session", [])}
    for view in views:
        view.page.context.close()
    for session in sessions:  # a server takes so many, and this one serves the whole folder
        server.http.delete(f"/api/sessions/{session}")
    for view in views:
        assert view.complaints == []
        assert view.foreign == []


@pytest.fixture
def view(view_of: ViewOf) -> View:
    """A page on a new session of the matte scene, whose picture shows every edit."""
    return view_of().open()


def bouncing_in(view_of: ViewOf, server: Server, **options: Any) -> View:  # noqa: ANN401 - as ViewOf
    """A page on a stone that bounces for ever once it falls; the default one lies still after two seconds."""
    lively = {"restitution": 1, "friction": 0, "rolling_resistance": 0, "tangential_damping": 1}
    scene: dict[str, Any] = {"floor": {"kind": "matte"}, "simulation": lively}
    answer = server.http.post("/api/sessions", json={"scene": scene})
    return view_of(**options).open(f"?session={answer.json()['id']}")


@pytest.fixture
def bouncing(view_of: ViewOf, server: Server) -> View:
    """A page on a stone that falls, and bounces for ever."""
    view = bouncing_in(view_of, server)
    view.page.keyboard.press("p")
    view.until("() => culet.state.falling && culet.lastFrame.simulationTime > 0.1")
    return view
