"""A real `culet serve` process, and what can be seen of it from outside."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx

from shared import patience

PATIENCE = patience.PATIENCE
SHOP = "http://shop.example"
"""A site that may show the page and its pictures."""
EMBEDDING = ("--frame-ancestor", SHOP, "--allow-embedding")
SILENCE_SECONDS = "10"
"""Without a heartbeat, of which one comes a second, until an engine counts as down: other work may hold it up."""


class Server:
    """Engine and gateway on a free port of loopback, for as long as the `with` lasts."""

    def __init__(self, folder: Path, *options: str, port: int = 0, stops_by_killing: bool = False) -> None:
        """`options` are further ones of the command; one that would drain is killed at the end."""
        self._options = options
        self._port = port
        self._stops_by_killing = stops_by_killing
        self._messages = folder / "serve.log"
        self.url = ""

    def __enter__(self) -> Server:
        with self._messages.open("wb") as messages:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "culet", "serve", "--port", str(self._port), *EMBEDDING, *self._options],
                stdout=subprocess.PIPE,
                stderr=messages,
                env={"CULET_ENGINE_SILENCE_SECONDS": SILENCE_SECONDS, "CULET_REQUEST_SECONDS": f"{PATIENCE:g}"}
                | os.environ,
            )
        self.url = self._announced()
        self.http = httpx.Client(base_url=self.url, timeout=PATIENCE)
        assert self.http.get("/readyz").status_code == 200, "it says that it is ready, and is not"
        return self

    def __exit__(self, *_: object) -> None:
        self.http.close()
        if self._stops_by_killing:
            self.kill()
        self._process.terminate()
        assert self._process.stdout is not None
        self._process.stdout.close()
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
            raise

    def session(self, session: str) -> dict[str, Any]:
        """What the REST interface says of a session."""
        answer = self.http.get(f"/api/sessions/{session}")
        assert answer.status_code == 200, answer.text
        description: dict[str, Any] = answer.json()
        return description

    def metrics(self) -> dict[str, float]:
        """/metrics, by name; without the `culet_` that all of them have."""
        lines = [line.split() for line in self.http.get("/metrics").text.splitlines() if not line.startswith("#")]
        return {name.removeprefix("culet_"): float(value) for name, value in lines}

    def until(self, name: str, value: float) -> None:
        """Wait until that metric is at least so large."""
        for metrics in self._looks():
            if metrics.get(name, -1) >= value:
                return

    def until_equal(self, name: str, value: float) -> None:
        """Wait until that metric has that value."""
        for metrics in self._looks():
            if metrics.get(name) == value:
                return

    def live_for(self, seconds: float) -> None:
        """Wait until the engine is so much older."""
        self.until("engine_uptime_seconds", self.metrics()["engine_uptime_seconds"] + seconds)

    def engine_pid(self) -> int:
        """Process id of the engine that works: the eldest, as the one that stands by was started after it."""
        for pid in _children(self._process.pid):
            if b"engine" in _words(pid):
                return pid
        raise AssertionError("the server has no engine")

    def gateway_pid(self) -> int:
        """Process id of the gateway that works, likewise."""
        for pid in _children(self._process.pid):
            if b"culet.gateway.inherited" in _words(pid):
                return pid
        raise AssertionError("the server has no gateway")

    @contextmanager
    def engine_gone(self) -> Iterator[None]:
        """The engine is killed, and no other one is started for as long as the `with` lasts; one that only stood still
        would end itself after a while."""
        engine = self.engine_pid()
        os.kill(self._process.pid, signal.SIGSTOP)
        try:
            os.kill(engine, signal.SIGKILL)
            self.until_equal("engine_up", 0)
            yield
        finally:
            os.kill(self._process.pid, signal.SIGCONT)

    def kill_all(self) -> None:
        """Both processes at once, and those that stand by: what none but the page knows is lost."""
        for pid in _children(self._process.pid):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    @property
    def is_running(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def kill(self) -> None:
        """The server as a whole: what it keeps running ends with it."""
        self._process.kill()
        self._process.wait()

    def until_compiled(self) -> None:
        """Wait until no process compiles for the engine: what it makes renders the picture anew."""
        threads = Path(f"/proc/{self.engine_pid()}/task")
        for _ in self._looks():
            with suppress(FileNotFoundError, ProcessLookupError):  # a thread that has ended meanwhile
                if not any(thread.read_text() for thread in threads.glob("*/children")):
                    return

    def _announced(self) -> str:
        """The URL that it prints once it is ready."""
        assert self._process.stdout is not None
        readable, _, _ = select.select([self._process.stdout], [], [], PATIENCE)
        line = self._process.stdout.readline().decode() if readable else ""
        assert line.startswith("culet is ready: http://"), f"{line!r}\n{self._messages.read_text()}"
        return line.removeprefix("culet is ready: ").strip().rstrip("/")

    def _looks(self) -> Iterator[dict[str, float]]:
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            metrics = self.metrics()
            yield metrics
            time.sleep(0.02)  # between two looks at another process
        raise AssertionError(f"waited {PATIENCE:g} s in vain; now {metrics}\n{self._messages.read_text()}")


def waited_until(condition: Callable[[], bool]) -> None:
    """Wait until a condition is true of what others do."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, f"waited {PATIENCE:g} s in vain"
        time.sleep(0.05)  # between two looks at other processes


def _children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def _words(pid: int) -> list[bytes]:
    """Of the command of a process; none if it has ended."""
    with suppress(FileNotFoundError, ProcessLookupError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
    return []
