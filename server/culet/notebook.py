"""A live view in a notebook's cell: a server in the background, and a frame that shows a session of it."""

from __future__ import annotations

import atexit
import html
import io
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from pathlib import Path
from queue import Empty, Queue
from typing import Any, Self

from PIL import Image

from culet.errors import EngineUnavailableError, InputError
from culet.parent import ending_with
from culet.scene import Scene
from culet.settings import variable
from culet.sources import load_scene
from culet_client.rest import Rest
from culet_protocol.messages import SessionEvent

HEIGHT = 480
"""Pixels of a browser, of the frame."""
START_SECONDS = 180.0
"""Until the server must be ready, as the one of `culet serve`: kernels may have to be compiled first."""
STOP_SECONDS = 10.0
IDLE_SECONDS = 7 * 24 * 3600.0
"""A cell may be looked at again days later; the server ends with the notebook's process at the latest."""
READY = "culet is ready: "
LOCAL_PAGES = ("http://localhost:*", "http://127.0.0.1:*")
"""Notebooks that may show the page in a frame though they come from another port."""


class View:
    """A scene that a server shows and lets fall; in a notebook it shows itself. Made by `culet.view`."""

    def __init__(
        self, server: _Server, shown: Scene, files: Mapping[str, Path], height: float, *, ui: bool, rotate: float
    ) -> None:
        self._server, self._height = server, height
        self._rest = Rest(server.address, START_SECONDS)
        self._bare = ("" if ui else "&ui=0") + (f"&rotate={rotate:g}" if rotate else "")
        scene = shown.model_dump(mode="json")
        if "meshes" in files:
            scene["stones"][0]["mesh"] = self._bring("meshes", files["meshes"])
        if "skies" in files:
            scene["environment"]["image"] = self._bring("skies", files["skies"])
        self.session = self._rest.make_session(scene, None)
        """The session's id: `culet_client.connect(view.url)` watches and steers the same."""
        server.views.add(self.session)

    def _bring(self, kind: str, file: Path) -> str:
        """The id of a file that the server has then."""
        return self._rest.upload(kind, file.name, file.read_bytes())

    @property
    def url(self) -> str:
        """Address of the page on this machine."""
        return f"{self._server.address}/?session={self.session}{self._bare}"

    @property
    def scene(self) -> Scene:
        """As it is seen now: with the camera and the stones where they are."""
        return Scene.read(self._rest.scene(self.session))

    def update(self, patch: Mapping[str, Any]) -> Self:
        """Change parts of the scene by a merge patch, such as `{"stones": {"stone": {"material": "ruby"}}}`.

        RefusedError (`culet_client`) says why that cannot be; its `field` names the place.
        """
        self._rest.patch(self.session, dict(patch))
        return self

    def send(self, event: SessionEvent) -> Self:
        """Do what a viewer can do, such as `culet_protocol.messages.ToggleFall()`; RefusedError as of `update`."""
        self._rest.tell(self.session, event)
        return self

    def picture(
        self,
        width: int | None = None,
        height: int | None = None,
        *,
        samples: int | None = None,
        error: float | None = None,
    ) -> Image.Image:
        """What is seen now, rendered by the server at full quality: as large as the frame, or as is asked for.

        (height, width) pixels of RGB; of a scene with a transparent background RGBA. `numpy.asarray` makes an
        array of it.
        """
        asked = {"width": width, "height": height, "samples": samples, "error": error}
        return Image.open(io.BytesIO(self._rest.frame(self.session, "png", asked)))

    def stop(self) -> None:
        """Forget the session; with the last view of this process its server ends. Twice is as good as once."""
        if self.session in self._server.views:
            self._server.views.discard(self.session)
            if self._server.views and self._server.alive:
                self._rest.forget_session(self.session)
            else:
                self._server.stop()

    def _repr_html_(self) -> str:
        source = html.escape(f"{self._server.seen_at}?session={self.session}{self._bare}")
        return (
            f'<iframe src="{source}" title="culet" allow="clipboard-write; fullscreen" '
            f'style="width: 100%; height: {self._height:g}px; border: 0"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<View of {self.url}>"


def view(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str] | None = None,
    *,
    height: float = HEIGHT,
    ui: bool = False,
    rotate: float = 0,
    through: str | None = None,
    mesh: str | os.PathLike[str] | None = None,
    sky: str | os.PathLike[str] | None = None,
) -> View:
    """Show a scene live, in a notebook's cell: drag, zoom, let it fall.

    The first view of a process starts a server in the background, which listens on this machine alone, and ends with
    the last view's `stop` or with the process, however that ends.

    Args:
        scene: as `load_scene` takes it: a preset's name, a mapping, a file, a Scene; without it the default scene.
        height: of the frame in the cell, pixels of the browser, 50 to 4000; it is as wide as the cell.
        ui: whether panel and buttons are shown, and not the picture alone.
        rotate: degrees a second by which the view turns by itself, -360 to 360.
        through: where the browser reaches the server's port, if that is not on the browser's machine: a path of the
            notebook's own site, or an address, with `{port}` in it. Under JupyterHub it is, by itself,
            `<prefix>/proxy/{port}/`, where jupyter-server-proxy has it.
        mesh: file of a mesh or of a design that takes the place of the scene's stone; as `render` takes it.
        sky: file with a panorama that becomes the scene's sky; as `render` takes it.

    Raises:
        InputError: for what cannot be used; `field` names it.
        EngineUnavailableError: if the server does not start; it says what the server said.
    """
    _check("height", height, 50, 4000, "pixels")
    _check("rotate", rotate, -360, 360, "degrees a second")
    through = _through(through)
    files = {kind: Path(file) for kind, file in (("meshes", mesh), ("skies", sky)) if file is not None}
    if files:  # what they cannot be is said before a server is started
        from culet.stills import stage_of

        shown = stage_of(scene, mesh, sky)[0].scene
    else:
        shown = load_scene(scene)
    return View(_server(through), shown, files, height, ui=ui, rotate=rotate)


def _check(field: str, value: object, lowest: int, highest: int, unit: str) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not lowest <= value <= highest:
        raise InputError(f"{field}: expected {lowest} to {highest} {unit}, got {value!r}", field)


def _through(given: str | None) -> str | None:
    """Where the browser is to look; None for this machine."""
    prefix = os.environ.get("JUPYTERHUB_SERVICE_PREFIX")
    if given is None:
        return f"{prefix.rstrip('/')}/proxy/{{port}}/" if prefix else None
    if "{port}" not in given or not given.startswith(("/", "http://", "https://")):
        raise InputError(
            f"through: expected a path or an address with {{port}} in it, such as /proxy/{{port}}/, got {given!r}",
            "through",
        )
    return given if given.endswith("/") else f"{given}/"


class _Server:
    """`culet serve` in a process of its own."""

    def __init__(self, through: str | None) -> None:
        self.through, self.owner = through, os.getpid()
        self.views: set[str] = set()
        self._process: subprocess.Popen[str] | None = None
        self._messages = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the process
        words: Queue[str] = Queue()
        # A process ends with the thread that started it, so that thread must stay: the caller's may not.
        threading.Thread(target=self._run, args=(words,), name="culet.view", daemon=True).start()
        try:
            said = words.get(timeout=START_SECONDS)
        except Empty:
            said = ""
        if not said.startswith(READY):
            self.stop()
            self._messages.seek(0)
            told = self._messages.read().decode(errors="replace").strip() or f"nothing within {START_SECONDS:g} s"
            raise EngineUnavailableError(f"culet serve did not start; it said: {told}")
        self.address = said.removeprefix(READY).strip().rstrip("/")
        atexit.register(self.stop)

    @property
    def seen_at(self) -> str:
        """Where the browser finds the page."""
        if self.through is None:
            return f"{self.address}/"
        return self.through.replace("{port}", self.address.rpartition(":")[2])

    @property
    def alive(self) -> bool:
        """Whether it runs, for this process and not for one that this was forked from."""
        return self._process is not None and self.owner == os.getpid() and self._process.poll() is None

    def stop(self) -> None:
        """End it, and wait for that."""
        if self._process is None or not self.alive:
            return
        self._process.terminate()
        try:
            self._process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        atexit.unregister(self.stop)

    def _run(self, words: Queue[str]) -> None:
        try:
            process = self._process = subprocess.Popen(  # noqa: S603 - this environment's own culet
                [sys.executable, "-m", "culet", "serve", *_options(self.through)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=self._messages,
                env=_environment(),
                start_new_session=True,  # Ctrl-C, and a notebook's Interrupt, are for the caller alone
                preexec_fn=ending_with(os.getpid()),  # noqa: PLW1509 - as the supervisor does
                text=True,
            )
        except OSError as error:
            self._messages.write(str(error).encode())
        else:
            assert process.stdout is not None  # noqa: S101 - a pipe
            for line in process.stdout:
                words.put(line)
            process.wait()
        words.put("")


def _environment() -> dict[str, str]:
    """This process's own, but for the token of other servers: the frame of a page of another site has no cookie."""
    return {name: value for name, value in os.environ.items() if name != variable("token")} | {
        variable("no_token"): "true"
    }


def _options(through: str | None) -> list[str]:
    options = ["--host", "127.0.0.1", "--port", "0", "--no-spare", "--session-idle-seconds", f"{IDLE_SECONDS:g}"]
    options += ["--unwatched-session-seconds", f"{IDLE_SECONDS:g}"]
    if through is None:
        return [*options, *(word for page in LOCAL_PAGES for word in ("--frame-ancestor", page))]
    # What a proxy of the notebook's forwards bears the name that the browser knows, which is not known here.
    options += ["--allow-host", "*", "--trusted-proxy", "127.0.0.1"]
    if "://" in through:
        site = "/".join(through.split("/")[:3])
        options += ["--allow-origin", site, "--frame-ancestor", site]
    return options


_servers: dict[str | None, _Server] = {}
"""By where the browser finds them: one, unless views of one process are looked at in several ways."""
_STARTING = threading.Lock()


def _server(through: str | None) -> _Server:
    """The one that runs, or a new one."""
    with _STARTING:
        running = _servers.get(through)
        if running is None or not running.alive:
            running = _servers[through] = _Server(through)
        return running
