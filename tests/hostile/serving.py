"""A `culet serve` to be hard on: its processes, its interface, its end."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

import httpx
import psutil

from shared import patience

T = TypeVar("T")

PATIENCE = patience.PATIENCE
MIB = 2**20

FALLING: Mapping[str, Any] = {
    "stones": [{"position": [0, 4, 0]}],
    "simulation": {"restitution": 1, "friction": 0, "rolling_resistance": 0, "tangential_damping": 1},
}
"""A stone that bounces for as long as anybody looks."""


class Serving:
    """`culet serve` with these options on a free port of loopback, in its own group of processes."""

    def __init__(self, *options: str, environment: Mapping[str, str] | None = None, files: int | None = None) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="culet-hostile-")
        self.log = Path(self._folder.name, "serve.log")
        command = [sys.executable, "-m", "culet", "serve", "--port", "0", *options]
        if files is not None:  # as where a service may open so many
            command = ["sh", "-c", f'ulimit -n {files}; exec "$@"', "sh", *command]
        self._command = command
        self._environment = {**os.environ, "TMPDIR": self._folder.name, **(environment or {})}
        self.url = ""

    def __enter__(self) -> Serving:
        with self.log.open("wb") as log:
            self._process = subprocess.Popen(
                self._command, stdout=subprocess.PIPE, stderr=log, env=self._environment, text=True
            )
        assert self._process.stdout
        readable, _, _ = select.select([self._process.stdout], [], [], PATIENCE)
        line = self._process.stdout.readline() if readable else ""
        assert line.startswith("culet is ready: http://"), f"{line!r}\n{self.log.read_text()}"
        self.url = line.removeprefix("culet is ready: ").strip().rstrip("/")
        self.http = httpx.Client(base_url=self.url, timeout=PATIENCE)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        self.http.close()
        if error is not None:
            error.add_note(f"the server's log ended in:\n{self.log.read_text()[-2000:]}")
        children = self._children()
        self._process.terminate()
        try:
            ended = self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            ended = None
            self._process.kill()
            self._process.wait()
        assert self._process.stdout
        self._process.stdout.close()
        outlived = []
        for process in psutil.wait_procs(children, timeout=PATIENCE)[1]:
            with contextlib.suppress(psutil.NoSuchProcess):
                outlived.append(" ".join(process.cmdline()))
                process.kill()
        self._folder.cleanup()
        if error is None:
            assert ended == 0, f"told to stop, it ended with {ended}"
            assert not outlived, f"processes outlived it: {outlived}"

    @property
    def stream_url(self) -> str:
        """Without the session."""
        return self.url.replace("http", "ws", 1)

    @property
    def port(self) -> int:
        """Of loopback."""
        return int(self.url.rpartition(":")[2])

    @property
    def alive(self) -> bool:
        """Whether `culet serve` itself runs."""
        return self._process.poll() is None

    @property
    def engine(self) -> psutil.Process:
        """The engine that serves: of those that run the oldest, since another may stand by."""
        return eventually(lambda: _oldest(self._named("engine")))

    @property
    def gateway(self) -> psutil.Process:
        """The process that answers."""
        return eventually(lambda: _oldest(self._named("gateway", "culet.gateway.inherited")) or self._parent)

    def memory(self) -> float:
        """MiB of all its processes together."""
        total = 0
        for process in (self._parent, *self._children()):
            try:
                total += process.memory_info().rss
            except psutil.NoSuchProcess:
                continue
        return total / MIB

    def session(self, scene: Mapping[str, Any] | None = None, http: httpx.Client | None = None) -> str:
        """A new session's id; `http` is that of another client."""
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = (http or self.http).post("/api/sessions", json={"scene": dict(scene or {})})
            if answer.status_code != 429 or time.monotonic() > deadline:
                break
            time.sleep(float(answer.headers["Retry-After"]))  # its shapes took long, and are kept for the next try
        assert answer.status_code == 201, answer.text
        session: str = answer.json()["id"]
        return session

    def falling(self) -> str:
        """A new session whose stone falls."""
        session = self.session(FALLING)
        answer = self.http.post(f"/api/sessions/{session}/events", json={"type": "toggle_fall"})
        assert answer.status_code < 300, answer.text
        return session

    def forget(self, *sessions: str) -> None:
        """Delete them, so that those of the next trial have the engine for themselves."""
        for session in sessions:
            self.http.delete(f"/api/sessions/{session}")

    def kill(self, process: psutil.Process, number: signal.Signals = signal.SIGKILL) -> None:
        """Send it a signal; a process that has ended already needs none."""
        try:
            process.send_signal(number)
        except psutil.NoSuchProcess:
            return

    def until_ready(self) -> None:
        """Wait until it answers with an engine."""
        eventually(self._is_ready)

    def _is_ready(self) -> bool:
        try:
            return self.http.get("/readyz").status_code == 200
        except httpx.HTTPError:
            return False

    @property
    def _parent(self) -> psutil.Process:
        return psutil.Process(self._process.pid)

    def _children(self) -> list[psutil.Process]:
        try:
            return self._parent.children(recursive=True)
        except psutil.NoSuchProcess:
            return []

    def _named(self, *words: str) -> list[psutil.Process]:
        found = []
        for process in self._children():
            try:
                if any(word in process.cmdline() for word in words) and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
            except psutil.NoSuchProcess:
                continue
        return found


def eventually(look: Callable[[], T | None]) -> T:
    """The first answer that is true, from now on."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        if found := look():
            return found
        time.sleep(0.02)  # between two looks at other processes
    raise AssertionError(f"waited {PATIENCE:g} s in vain")


def _oldest(processes: list[psutil.Process]) -> psutil.Process | None:
    return min(processes, key=lambda process: process.create_time(), default=None)
