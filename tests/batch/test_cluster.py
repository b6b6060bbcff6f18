"""Workers make the frames that one process makes, each once, whoever is killed meanwhile."""

from __future__ import annotations

import csv
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import psutil
import pytest

import culet
from batch.workers import Command, check_frames, ended, interrupt, line_told, numbers_in, started, until, workers_of
from batch_extra import needs_dask
from command_line import culet as run_culet
from command_line import invoke
from culet.batch.animation import Animation, times_of, turntable
from culet.batch.edition import edition
from culet.scene import Scene
from culet.stage import Stage
from shared.ports import free_port

SIZE, SAMPLES = (96, 54), 2
FRAMES = 60


def asked(frames: int = FRAMES) -> Animation:
    """What `animate` asks for."""
    return Animation(turntable(Stage.of(Scene()), times_of(frames / 10, 10)), *SIZE, SAMPLES)


def animate(folder: Path, *arguments: str | Path, frames: int = FRAMES) -> tuple[str | Path, ...]:
    """A command of so many frames."""
    size = ("--width", str(SIZE[0]), "--height", str(SIZE[1]), "--samples", str(SAMPLES))
    return ("animate", "--turntable", "--seconds", str(frames / 10), "--fps", "10", *size, "-o", folder, *arguments)


def at_least(number: int, folder: Path, command: Command) -> None:
    """Wait for so many frames."""
    until(lambda: len(numbers_in(folder)) >= number, command)


def killed(processes: list[psutil.Process]) -> None:
    """By a signal that leaves no time."""
    for process in processes:
        process.send_signal(signal.SIGKILL)


@needs_dask
@pytest.mark.validation
def test_a_killed_worker_is_replaced_and_ctrl_c_leaves_whole_frames_and_no_process(tmp_path: Path) -> None:
    """Of more frames than are made while this looks away."""
    folder, many = tmp_path / "f", 2000
    with started(*animate(folder, "--workers", "2", frames=many)) as command:
        at_least(2, folder, command)
        (one, *_), before = workers_of(command), len(numbers_in(folder))
        killed([one])
        at_least(before + 6, folder, command)
        until(lambda: len([each for each in workers_of(command) if each.pid != one.pid]) == 2, command)
        processes = psutil.Process(command.pid).children(recursive=True)
        interrupt(command)
        code, _, err = ended(command)
        assert (code, err) == (130, "")
        assert psutil.wait_procs(processes, timeout=60)[1] == []
    found = numbers_in(folder)
    assert len(found) == len(set(found)) < many
    check_frames(asked(many), folder, found[:4] + found[-4:])


@needs_dask
@pytest.mark.soak
@pytest.mark.parametrize("number", [1, 2], ids=["one", "all"])
def test_every_frame_is_made_once_though_workers_are_killed(tmp_path: Path, number: int) -> None:
    folder = tmp_path / "f"
    with started(*animate(folder, "--workers", "2")) as command:
        at_least(3, folder, command)
        killed(workers_of(command)[:number])
        assert len(numbers_in(folder)) < FRAMES
        code, out, err = ended(command)
        assert (code, out) == (0, f"{folder}: {FRAMES} frames of {SIZE[0]} x {SIZE[1]}\n")
        # Those of this command are replaced by itself; how soon is the machine's.
        assert err == "" or (number == 2 and "this command has had none" in err)
    assert sorted(numbers_in(folder)) == list(range(FRAMES))
    check_frames(asked(), folder, list(range(FRAMES)))


@needs_dask
@pytest.mark.soak
def test_what_ctrl_c_has_stopped_goes_on_with_other_workers_or_with_none(tmp_path: Path) -> None:
    folder = tmp_path / "f"
    for number, workers in enumerate((("--workers", "2"), ("--workers", "3"), ())):
        with started(*animate(folder, *workers)) as command:
            at_least(4 + 10 * number, folder, command)
            interrupt(command)
            assert ended(command)[0] == 130
    assert len(numbers_in(folder)) < FRAMES
    done = run_culet(*animate(folder, "--workers", "2"))
    assert done.returncode == 0, done.stderr
    assert sorted(numbers_in(folder)) == list(range(FRAMES))
    check_frames(asked(), folder, list(range(FRAMES)))


def certificate(folder: Path, name: str) -> tuple[str | Path, ...]:
    """One that rests on itself, for all who speak, as options of culet."""
    own, key = folder / f"{name}.pem", folder / f"{name}.key"
    options = ["-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=batch"]
    subprocess.run(["openssl", "req", "-x509", *options, "-keyout", key, "-out", own], check=True, capture_output=True)
    return "--tls-ca", own, "--tls-cert", own, "--tls-key", key


class Cluster:
    """Dask's own scheduler and workers, as an administrator starts them."""

    def __init__(self, address: str, tls: tuple[str | Path, ...], log: Path) -> None:
        self.address = address
        self._tls = tuple(option if option != "--tls-ca" else "--tls-ca-file" for option in tls)
        self._log = log
        self._stack = ExitStack()

    def __enter__(self) -> Cluster:
        self._file = self._stack.enter_context(self._log.open("ab"))
        scheme, _, port = self.address.split(":")
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", port, "--protocol", scheme)
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def work(self, *arguments: str, path: Path | None = None) -> subprocess.Popen[bytes]:
        """Workers; with the modules of that folder before others."""
        return self._start("worker", self.address, "--host", "127.0.0.1", "--nthreads", "1", *arguments, path=path)

    def _start(self, role: str, *arguments: str, path: Path | None = None) -> subprocess.Popen[bytes]:
        words = [sys.executable, "-m", f"distributed.cli.dask_{role}", *arguments, "--no-dashboard", *self._tls]
        there = ["env", *([] if path is None else [f"PYTHONPATH={path}"])]
        process = subprocess.Popen([*there, *words], stdout=self._file, stderr=self._file)
        self._stack.callback(self._end, process)
        return process

    @staticmethod
    def _end(process: subprocess.Popen[bytes]) -> None:
        if process.poll() is None:
            others = psutil.Process(process.pid).children(recursive=True)
            process.kill()
            killed([each for each in others if each.is_running()])
        process.wait()


@needs_dask
@pytest.mark.soak
def test_a_killed_scheduler_is_told_and_the_same_command_goes_on_with_another_one(tmp_path: Path) -> None:
    tls, folder = certificate(tmp_path, "own"), tmp_path / "f"
    address = f"tls://127.0.0.1:{free_port()}"
    command_line = animate(folder, "--scheduler", address, *tls)
    with Cluster(address, tls, tmp_path / "first.log") as cluster:
        cluster.work("--nworkers", "2")
        with started(*command_line) as command:
            at_least(3, folder, command)
            cluster.scheduler.kill()
            code, _, err = ended(command)
    assert (code, err.count("\n")) == (1, 1)
    assert re.match(rf"culet: workers: the scheduler at {address} cannot be reached any more \(.*\); the same", err)
    assert 3 <= len(numbers_in(folder)) < FRAMES
    with Cluster(address, tls, tmp_path / "second.log") as cluster:
        cluster.work()
        stranger = certificate(tmp_path, "strange")
        refused = run_culet(*animate(tmp_path / "g", "--scheduler", address, *stranger))
        assert refused.returncode == 1
        assert f"nothing that answers as one at {address}" in refused.stderr
        done = run_culet(*command_line)
        assert done.returncode == 0, done.stderr
    assert sorted(numbers_in(folder)) == list(range(FRAMES))
    check_frames(asked(), folder, list(range(FRAMES)))


@needs_dask
@pytest.mark.soak
def test_that_all_workers_are_gone_is_told_and_another_one_goes_on(tmp_path: Path) -> None:
    folder, address = tmp_path / "f", f"tcp://127.0.0.1:{free_port()}"
    with Cluster(address, (), tmp_path / "log") as cluster:
        worker = cluster.work("--no-nanny")
        with started(*animate(folder, "--scheduler", address)) as command:
            at_least(2, folder, command)
            worker.kill()
            told = line_told(command)
            assert re.fullmatch(
                rf"culet: workers: the scheduler at {address} has had none for \d+ s; it waits .*\n", told
            )
            assert len(numbers_in(folder)) < FRAMES
            cluster.work("--no-nanny")
            assert (
                line_told(command)
                == f"culet: workers: the scheduler at {address} has workers again; the work goes on\n"
            )
            assert ended(command)[0] == 0
    assert sorted(numbers_in(folder)) == list(range(FRAMES))


def optimise(*arguments: str | Path, evaluations: int) -> tuple[str | Path, ...]:
    """A command of a quick search."""
    return ("design", "optimise", "single", "--evaluations", str(evaluations), *arguments)


@needs_dask
@pytest.mark.soak
def test_a_search_by_workers_finds_what_one_process_finds(tmp_path: Path) -> None:
    alone = invoke(*optimise("-o", tmp_path / "alone.csv", evaluations=18))
    by_workers = run_culet(*optimise("-o", tmp_path / "workers.csv", "--workers", "2", evaluations=18))
    assert (alone.returncode, by_workers.returncode, by_workers.stderr) == (0, 0, "")
    assert (tmp_path / "workers.csv").read_bytes() == (tmp_path / "alone.csv").read_bytes()
    assert by_workers.stdout == alone.stdout.replace("alone.csv", "workers.csv")


@needs_dask
@pytest.mark.soak
def test_a_search_goes_on_without_a_killed_worker_and_ctrl_c_tells_what_was_found(tmp_path: Path) -> None:
    table = tmp_path / "front.csv"
    with started(*optimise("-o", table, "--workers", "2", evaluations=2000)) as command:
        at_work = lambda: [busy_for(each) > 8 for each in workers_of(command)] == [True, True]  # noqa: E731
        until(at_work, command)
        killed(workers_of(command)[:1])
        until(at_work, command)
        interrupt(command)
        code, out, err = ended(command)
    assert (code, "culet: interrupted after " in err) == (130, True), err
    graded = int(err.split("interrupted after ")[1].split()[0])
    assert 1 < graded < 2000
    assert f"no other of {graded} beats" in out
    assert len(table.read_text().splitlines()) > 1


def busy_for(process: psutil.Process) -> float:
    """s of processor time; of one that is gone none."""
    try:
        return float(process.cpu_times().user)
    except psutil.NoSuchProcess:
        return 0.0


@contextmanager
def another_culet(folder: Path) -> Iterator[Path]:
    """A folder with a culet that differs in one line, whose pictures might."""
    package = Path(culet.__file__).parent
    shutil.copytree(package, folder / "culet", ignore=shutil.ignore_patterns("page", "__pycache__"))
    (folder / "culet" / "another.py").write_text('"""One module more."""\n')
    yield folder


@needs_dask
@pytest.mark.soak
def test_workers_of_another_edition_are_refused_by_name(tmp_path: Path) -> None:
    """Those who are there, and those who come later."""
    address = f"tcp://127.0.0.1:{free_port()}"
    with another_culet(tmp_path / "other") as other, Cluster(address, (), tmp_path / "log") as cluster:
        wrong = cluster.work(path=other)
        refused = run_culet(*animate(tmp_path / "f", "--scheduler", address))
        told = (
            rf"culet: workers: expected culet {re.escape(edition())} on each, got \S+ \(\w+\) on tcp://127.0.0.1:\d+\n"
        )
        assert (refused.returncode, bool(re.fullmatch(told, refused.stderr))) == (1, True), refused.stderr
        wrong.terminate()
        wrong.wait(60)
        cluster.work()
        folder = tmp_path / "g"
        with started(*animate(folder, "--scheduler", address, frames=2000)) as command:
            at_least(2, folder, command)
            cluster.work(path=other)
            code, _, err = ended(command)
            assert (code, bool(re.fullmatch(told, err))) == (1, True), err


@needs_dask
@pytest.mark.validation
def test_a_sweep_by_workers_is_the_table_of_one_process(tmp_path: Path) -> None:
    words = ("sweep", "oval", "--vary", "cut.crown_degrees=30,95,34", "--metric", "iso", "--error", "5", "-o")
    alone_done = invoke(*words, tmp_path / "alone.csv")
    workers_done = run_culet(*words, tmp_path / "workers.csv", "--workers", "2")
    assert (alone_done.returncode, workers_done.returncode) == (0, 0), workers_done.stderr
    alone, by_workers = ((tmp_path / name).read_bytes() for name in ("alone.csv", "workers.csv"))
    assert by_workers == alone
    assert [bool(row["problem"]) for row in csv.DictReader(alone.decode().splitlines())] == [False, True, False]


@needs_dask
@pytest.mark.validation
def test_schedulers_that_strangers_reach_are_refused(tmp_path: Path) -> None:
    for address, said in (
        ("tcp://10.0.0.1:8786", "would be neither encrypted nor closed to strangers"),
        ("tcp://batch.example:8786", "would be neither encrypted nor closed to strangers"),
        ("batch.example:8786", "expected tls://HOST:PORT"),
        ("ucx://127.0.0.1:8786", "expected tls://HOST:PORT"),
        ("tls://127.0.0.1:8786", "expected --tls-ca, --tls-cert and --tls-key"),
    ):
        refused = invoke(*animate(tmp_path / "f", "--scheduler", address))
        assert (refused.returncode, said in refused.stderr) == (1, True), refused.stderr
    missing = tmp_path / "none.pem"
    refused = invoke(*animate(tmp_path / "f", "--scheduler", "tls://127.0.0.1:8786", "--tls-cert", missing))
    assert refused.stderr == f"culet: tls-cert: there is no file {missing}\n"


def test_without_the_extra_a_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("culet.command.crew.find_spec", lambda name: None)
    for option, value in (("--workers", "2"), ("--scheduler", "tls://127.0.0.1:8786")):
        refused = invoke(*animate(tmp_path / "f", option, value))
        assert (refused.returncode, "pip install 'culet[batch]'" in refused.stderr) == (1, True)
        assert not (tmp_path / "f").exists()


def test_who_does_the_work_is_said_once(tmp_path: Path) -> None:
    both = invoke(*animate(tmp_path / "f", "--workers", "2", "--scheduler", "tls://127.0.0.1:8786"))
    assert "expected --workers or --scheduler, got both" in both.stderr
    alone = invoke(*animate(tmp_path / "f", "--tls-key", "key.pem"))
    assert "certificates are for a --scheduler" in alone.stderr
