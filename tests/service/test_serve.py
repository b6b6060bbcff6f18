"""`culet serve` as a whole: engine or gateway killed or held up, the parent killed, all told to stop."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import NamedTuple

import httpx
import pytest
from websockets.asyncio.client import connect

from culet.engine.process.watchdog import HANG_SECONDS
from culet.errors import EngineUnavailableError, InputError
from culet.gateway.listener import Listener
from culet.gateway.settings import GatewaySettings
from culet.service.serve import serve
from culet.service.supervisor import STARTS_BEFORE_GIVING_UP, ServerPart, Supervisor
from culet_client import FrameSubscription
from culet_protocol.frame import Flags, Frame
from culet_protocol.messages import Orbit, ToggleFall
from culet_protocol.watch import watch_id
from gateway.running import PATIENCE, SIZE, TETRAHEDRON, Viewer, announced, eventually, png

ENGINES = "culet_engine_processes_total"
"""The metric."""


class Served(NamedTuple):
    """A running `culet serve`."""

    process: subprocess.Popen[str]
    http: httpx.AsyncClient

    def engine(self) -> int | None:
        """Process id of the engine that works: the eldest, as the one that stands by was started after it."""
        return next(self._children("engine"), None)

    def gateway(self) -> int | None:
        """Process id of the gateway."""
        return next(self._children("culet.gateway.inherited"), None)

    async def engines(self) -> int:
        """That have come to work so far."""
        text = (await self.http.get("/metrics")).text
        return next(int(float(line.split()[1])) for line in text.splitlines() if line.startswith(ENGINES))

    def children(self) -> int:
        """Of its processes."""
        return len(Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split())

    def _children(self, word: str) -> Iterator[int]:
        for child in Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split():
            with contextlib.suppress(OSError):
                if word.encode() in Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0"):
                    yield int(child)

    @contextlib.asynccontextmanager
    async def viewer(self, session: str) -> AsyncIterator[Viewer]:
        """A viewer that has said its size."""
        url = str(self.http.base_url).replace("http", "ws", 1) + f"api/sessions/{session}/stream"
        async with connect(url, max_size=None) as websocket:
            viewer = Viewer(websocket)
            await viewer.say(SIZE)
            yield viewer


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """One `culet serve` and its address, for tests after which all of it works again."""
    with _serve(tmp_path_factory.mktemp("page"), "--special-programs") as running:
        yield running


@pytest.fixture
async def served(shared: tuple[subprocess.Popen[str], str]) -> AsyncIterator[Served]:
    """Ready. Whatever earlier tests have killed is replaced."""
    process, url = shared
    async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:

        async def ready() -> bool:
            return (await http.get("/readyz")).status_code == 200

        await eventually(ready)
        yield Served(process, http)


@pytest.fixture
async def own(tmp_path: Path) -> AsyncIterator[Served]:
    """For one test alone, which ends it. Nobody stands by, which costs as much again."""
    with _serve(tmp_path, "--no-spare") as (process, url):
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            yield Served(process, http)


@contextlib.contextmanager
def _serve(web: Path, *options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    (web / "index.html").write_text("<h1>the page</h1>")
    command = [sys.executable, "-m", "culet", "serve", "--port", "0", "--web", str(web), *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield process, announced(process)
    finally:
        process.terminate()
        try:
            process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
            process.wait()


def alive(pid: int) -> bool:
    """Whether the process runs; one that has ended and waits for its parent does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def ignores(pid: int, number: signal.Signals) -> bool:
    """Whether the process ignores a signal: bit number - 1 of a mask in proc(5)."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    mask = next(line.split()[1] for line in lines if line.startswith("SigIgn"))
    return bool(int(mask, 16) >> (number - 1) & 1)


def cpu_seconds(pid: int) -> float:
    """So far; proc(5): user and system time are fields 14 and 15."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")


async def compiles_nothing(pid: int) -> bool:
    """Whether no thread of the process has a child: each compiler is one."""
    with contextlib.suppress(OSError):  # a thread that has ended meanwhile
        return not any(thread.read_text() for thread in Path(f"/proc/{pid}/task").glob("*/children"))  # noqa: ASYNC240 - procfs does not block
    return False


async def ended(pid: int) -> None:
    async def gone() -> bool:
        return not alive(pid)

    await eventually(gone)


async def test_a_killed_engine_comes_back_with_the_same_sessions(served: Served) -> None:
    made = await served.http.post("/api/sessions", json={"preset": "matte"})
    session = made.json()["id"]
    async with served.viewer(session) as viewer:
        await viewer.say(Orbit(yaw=0.4, pitch=0.1))
        await viewer.until(lambda: bool(viewer.frames) and viewer.frames[-1].step > 1)
        before = (await served.http.get(f"/api/sessions/{session}")).json()
        engines = await served.engines()
        last = viewer.frames[-1]
        engine = served.engine()
        assert engine
        os.kill(engine, signal.SIGKILL)
        assert (await viewer.notice("engine"))["status"] == "down"
        assert (await viewer.notice("engine"))["status"] == "up"
        frame = await viewer.frame()
        assert frame.sequence > last.sequence, "frame numbers go on, so that none is taken for an old one"
        assert (await served.http.get(f"/api/sessions/{session}")).json() == before
        assert served.engine() not in (None, engine)
        assert await served.engines() == engines + 1


async def test_a_falling_stone_and_its_sky_from_uploads_go_on_in_the_next_engine(served: Served) -> None:
    upload = await served.http.post("/api/meshes", files={"file": ("stone.obj", TETRAHEDRON)})
    sky = await served.http.post("/api/skies", files={"file": ("sky.png", png(8, 4, (200, 100, 50)))})
    lively = {"restitution": 1, "tangential_damping": 1, "angular_damping": 1, "random_torque": 0}
    scene = {
        "stones": [{"mesh": upload.json()["id"], "position": [0, 3, 0]}],
        "environment": {"kind": "image", "image": sky.json()["id"]},
        "simulation": lively,
    }
    session = (await served.http.post("/api/sessions", json={"scene": scene})).json()["id"]
    async with served.viewer(session) as viewer:
        await viewer.say(ToggleFall())
        await viewer.until(lambda: bool(viewer.frames) and viewer.frames[-1].simulation_time > 2.5)
        engine = served.engine()
        assert engine
        os.kill(engine, signal.SIGKILL)
        await viewer.notice("engine")
        assert (await viewer.notice("engine"))["status"] == "up"
        frame = await viewer.frame()
    assert Flags.MOVING in frame.flags
    assert frame.simulation_time > 2.5 / 2, "from where it was a moment ago, and not from the start"


async def test_without_its_engine_the_gateway_says_so(served: Served) -> None:
    engine = served.engine()
    assert engine
    os.kill(engine, signal.SIGSTOP)  # it hangs, and does not end
    began = time.monotonic()
    try:

        async def unready() -> bool:
            return (await served.http.get("/readyz")).status_code == 503

        await eventually(unready)
        assert (await served.http.get("/healthz")).status_code == 200
        refused = await served.http.get("/api/render.tga")
        assert (refused.status_code, refused.json()["title"]) == (503, "engine unavailable")
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.kill(engine, signal.SIGCONT)
    paused = time.monotonic() - began

    async def ready() -> bool:
        return (await served.http.get("/readyz")).status_code == 200

    await eventually(ready)
    # It counts from its last beat, up to a second before, and ends itself if it went on too late.
    assert served.engine() == engine or paused >= HANG_SECONDS - 1, "one that only paused is not replaced"


async def test_a_stop_signal_ends_both_though_a_viewer_watches_and_a_still_is_made(own: Served) -> None:
    session = (await own.http.post("/api/sessions")).json()["id"]
    engine = own.engine()
    assert engine
    async with own.viewer(session) as viewer:
        await viewer.frame()
        scene = {"sampling": {"samples_per_pixel": 4096}}  # takes longer than PATIENCE
        picture = {"scene": scene, "width": 1920, "height": 1080}
        still = asyncio.create_task(own.http.post("/api/render", json=picture))

        async def under_way() -> bool:
            return "culet_engine_stills_waiting 1" in (await own.http.get("/metrics")).text

        await eventually(under_way)
        own.process.send_signal(signal.SIGINT)
        assert await asyncio.to_thread(own.process.wait, PATIENCE) == 0
        await viewer.websocket.wait_closed()
        assert viewer.websocket.close_code == 1012, "service restart"
        assert viewer.websocket.close_reason == "the server is stopping, or being restarted"
        refused = await still
        assert (refused.status_code, refused.json()["title"]) == (503, "engine unavailable")
        assert "retry-after" in refused.headers
    assert not alive(engine)


async def test_a_server_that_may_drain_ends_with_its_last_session_and_lets_a_killed_engine_come_back_until_then(
    tmp_path: Path,
) -> None:
    with _serve(tmp_path, "--drain-seconds", "600", "--no-spare") as (process, url):
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            served = Served(process, http)
            session = (await http.post("/api/sessions")).json()["id"]
            engine = served.engine()
            assert engine
            async with served.viewer(session) as viewer:
                await viewer.frame()
                process.send_signal(signal.SIGTERM)
                assert (await viewer.notice("leaving"))["seconds"] > 500
                assert (await http.post("/api/sessions")).status_code == 503
                os.kill(engine, signal.SIGKILL)
                await viewer.notice("engine")
                assert (await viewer.notice("engine"))["status"] == "up"
                await viewer.frame()
                assert (await http.delete(f"/api/sessions/{session}")).status_code == 204
                assert await asyncio.to_thread(process.wait, PATIENCE) == 0
                await viewer.websocket.wait_closed()


async def test_a_server_that_drains_ends_at_once_when_told_again(tmp_path: Path) -> None:
    with _serve(tmp_path, "--drain-seconds", "600", "--no-spare") as (process, url):
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            session = (await http.post("/api/sessions")).json()["id"]
            async with Served(process, http).viewer(session) as viewer:
                await viewer.frame()
                process.send_signal(signal.SIGTERM)
                await viewer.notice("leaving")
                process.send_signal(signal.SIGTERM)
                assert await asyncio.to_thread(process.wait, PATIENCE) == 0
                await viewer.websocket.wait_closed()
                assert viewer.websocket.close_code == 1012


async def test_a_server_that_its_administrator_drains_ends_as_a_whole_and_is_not_started_again(own: Served) -> None:
    assert (await own.http.post("/api/drain", json={"seconds": 500})).status_code == 202
    assert await asyncio.to_thread(own.process.wait, PATIENCE) == 0


async def test_an_engine_that_nobody_asks_for_anything_sleeps(served: Served) -> None:
    engine = served.engine()
    assert engine

    async def a_quiet_second() -> bool:
        """Of which it uses less than a fifth of a core: what it does after a start comes to an end."""
        began, before = time.monotonic(), cpu_seconds(engine)
        await asyncio.sleep(1)
        return cpu_seconds(engine) - before < 0.2 * (time.monotonic() - began)

    await eventually(lambda: compiles_nothing(engine))
    await eventually(a_quiet_second)


async def test_frames_are_published_where_native_viewers_want_them_and_to_the_page(tmp_path: Path) -> None:
    elsewhere = f"ipc://{tmp_path}/f"
    with _serve(tmp_path, "--frames", elsewhere, "--no-spare") as (process, url):
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            session = (await http.post("/api/sessions")).json()["id"]
            with FrameSubscription(elsewhere, watch_id(session)) as subscription:
                frame = await asyncio.to_thread(subscription.receive, PATIENCE)
            assert frame.watch.hex() == watch_id(session)
            async with Served(process, http).viewer(session) as viewer:
                assert (await viewer.frame()).watch.hex() == watch_id(session)


async def test_an_engine_does_not_outlive_a_killed_parent(own: Served, tmp_path: Path) -> None:
    engine = own.engine()
    assert engine
    command = Path(f"/proc/{engine}/cmdline").read_text()  # noqa: ASYNC240 - procfs does not block
    left_behind = Path(command.split("ipc://")[1].partition("\0")[0]).parent
    own.process.kill()
    await ended(engine)
    assert left_behind.exists(), "a killed process cannot tidy up"
    with _serve(tmp_path, "--no-spare"):
        assert not left_behind.exists(), "the next one does"


async def test_an_engine_that_never_starts_is_given_up(tmp_path: Path) -> None:
    supervisor = Supervisor(ServerPart("engine", ["false"], 10), tmp_path)
    with pytest.raises(EngineUnavailableError, match=r"the engine ended with code 1, 4 times in a row"):
        await supervisor.run()
    assert supervisor.starts == STARTS_BEFORE_GIVING_UP


async def test_an_engine_that_does_not_listen_is_killed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("culet.service.supervisor.STOP_SECONDS", 0.2)
    deaf = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(600)"
    supervisor = Supervisor(ServerPart("engine", [sys.executable, "-c", deaf], 10), tmp_path)
    running = asyncio.create_task(supervisor.run())

    async def started() -> bool:
        return supervisor.pid is not None and ignores(supervisor.pid, signal.SIGTERM)

    await eventually(started)
    pid = supervisor.pid
    assert pid
    await supervisor.stop()
    await running
    assert not alive(pid)
    assert supervisor.starts == 1


def test_a_taken_port_is_refused_before_anything_starts() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=rf"cannot listen on 127.0.0.1 port {port}: .*in use"):
            Listener(GatewaySettings(control="ipc://unused", frames="ipc://unused", port=port))


def test_frames_that_cannot_be_published_are_refused_before_anything_starts() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        in_use = f"tcp://127.0.0.1:{taken.getsockname()[1]}"
        for endpoint, reason in (("foo", "expected ipc://"), (in_use, "another program listens there")):
            with pytest.raises(InputError, match=f"--frames: cannot listen at '{endpoint}': {reason}"):
                serve({"port": "0"}, frames=endpoint)


async def test_without_a_spare_nobody_stands_by_and_what_dies_is_started_anew(tmp_path: Path) -> None:
    with _serve(tmp_path, "--no-spare") as (process, url):
        async with httpx.AsyncClient(base_url=url, timeout=PATIENCE) as http:
            served = Served(process, http)
            session = (await http.post("/api/sessions")).json()["id"]
            for pid in (served.gateway(), served.engine()):
                assert pid
                os.kill(pid, signal.SIGKILL)
                await ended(pid)

                async def back() -> bool:
                    with contextlib.suppress(httpx.TransportError):  # a connection that ended with the gateway
                        return (await http.get(f"/api/sessions/{session}")).status_code == 200
                    return False

                await eventually(back)
            assert served.children() == 2


async def test_the_gateways_process_holds_nothing_that_renders_or_measures(served: Served) -> None:
    """Also after it was asked for that: its memory counts for each server."""
    asked = await served.http.post("/api/design/tiers", json={"scene": {}})
    assert asked.status_code == 200, asked.text
    gateway = served.gateway()
    mapped = Path(f"/proc/{gateway}/maps").read_text()  # noqa: ASYNC240 - procfs does not block
    assert "/pydantic_core/" in mapped
    assert not [each for each in ("/scipy/", "/pyopencl/", "/simplejpeg/") if each in mapped]


async def test_a_killed_gateway_comes_back_with_the_sessions_that_the_engine_kept(served: Served) -> None:
    scene = {"floor": {"kind": "matte"}, "simulation": {"restitution": 1, "random_torque": 0}}
    session = (await served.http.post("/api/sessions", json={"scene": scene})).json()["id"]
    async with served.viewer(session) as viewer:
        await viewer.say(Orbit(yaw=0.4, pitch=0.1))
        await viewer.say(ToggleFall())
        await viewer.until(lambda: bool(viewer.frames) and viewer.frames[-1].simulation_time > 0.1)
        before = (await served.http.get(f"/api/sessions/{session}")).json()
        gateway, engine = served.gateway(), served.engine()
        assert gateway
        os.kill(gateway, signal.SIGKILL)
        await viewer.websocket.wait_closed()
        last = viewer.frames[-1]
    # Nobody waits for the gateway: the address answers all the time, only later.
    async with served.viewer(session) as viewer:
        await viewer.until(lambda: bool(viewer.frames) and viewer.frames[-1].sequence > last.sequence)
        assert viewer.frames[-1].simulation_time >= last.simulation_time, "the engine has gone on"
        assert (await viewer.notice("state"))["scene"] == before["scene"]
    assert served.gateway() not in (None, gateway)
    assert served.engine() == engine
    unknown = await served.http.get(f"/api/sessions/{'0' * 32}")
    assert unknown.status_code == 404, "and not 503: it knows all sessions now"


async def test_a_gateway_that_is_told_to_end_by_itself_is_followed_by_another(served: Served) -> None:
    session = (await served.http.post("/api/sessions")).json()["id"]
    gateway, engine = served.gateway(), served.engine()
    assert gateway
    os.kill(gateway, signal.SIGTERM)

    async def replaced() -> bool:
        return served.gateway() not in (None, gateway)

    await eventually(replaced)
    assert (await served.http.get(f"/api/sessions/{session}")).status_code == 200, "the address answers all the time"
    assert (served.process.poll(), served.engine()) == (None, engine)


SPEAKER = """
import sys, time
from culet.notify import ServiceNotice, notify, notify_patience
sys.stdin.readline()
notify_patience(float(sys.argv[1]))
notify(ServiceNotice.READY)
time.sleep(600)
"""
"""Asks for so much patience, says that it is ready, and then says nothing more."""


async def test_a_process_that_falls_silent_is_replaced_by_the_one_that_stands_by(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("culet.service.supervisor.SPARE_PAUSE_SECONDS", 0)
    part = ServerPart("engine", [sys.executable, "-c", SPEAKER, "1"], silence_seconds=0.3, has_spare=True)
    supervisor = Supervisor(part, tmp_path)
    running = asyncio.create_task(supervisor.run())

    async def replaced() -> bool:
        return supervisor.starts >= 3

    try:
        await eventually(replaced)
    finally:
        await supervisor.stop()
        await running


async def test_a_process_that_asks_for_patience_gets_it(tmp_path: Path) -> None:
    impatient, patient = (
        Supervisor(
            ServerPart(name, [sys.executable, "-c", SPEAKER, seconds], silence_seconds=1, has_spare=True), tmp_path
        )
        for name, seconds in (("impatient", "0.1"), ("patient", "600"))
    )
    running = [asyncio.create_task(supervisor.run()) for supervisor in (impatient, patient)]

    async def replaced_often() -> bool:
        return impatient.starts >= 4

    try:
        await eventually(replaced_often)
        assert patient.starts <= 2, "itself, and the one that stands by"
    finally:
        for supervisor in (impatient, patient):
            await supervisor.stop()
        await asyncio.gather(*running)


@pytest.mark.soak
async def test_an_engine_that_stands_still_is_replaced(served: Served) -> None:
    session = (await served.http.post("/api/sessions")).json()["id"]
    engine = served.engine()
    assert engine
    os.kill(engine, signal.SIGSTOP)
    async with served.viewer(session) as viewer:

        async def replaced() -> bool:
            return not alive(engine)

        await eventually(replaced)
        assert (await viewer.frame()).watch.hex() == watch_id(session)


async def test_a_resting_session_never_uses_a_number_again_however_often_the_engine_dies(own: Served) -> None:
    session = (await own.http.post("/api/sessions", json={"preset": "matte"})).json()["id"]
    async with own.viewer(session) as viewer:
        await viewer.final()

        async def shown_anew() -> list[Frame]:
            count = len(viewer.frames)
            await viewer.until(lambda: Flags.FINAL in viewer.frames[-1].flags and len(viewer.frames) > count)
            return viewer.frames[count:]

        for _ in range(2):
            last, engine = viewer.frames[-1], own.engine()
            assert engine
            os.kill(engine, signal.SIGKILL)
            assert (await viewer.notice("engine"))["status"] == "down"
            assert (await viewer.notice("engine"))["status"] == "up"
            after = [frame for frame in await shown_anew() if frame.sequence != last.sequence]
            assert min(frame.sequence for frame in after) > last.sequence
            assert min(frame.step for frame in after) > last.step
