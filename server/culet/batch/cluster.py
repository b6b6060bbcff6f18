"""Workers by Dask: processes of this machine, or those that a scheduler has. Needs the extra culet[batch].

Results come to this process, which alone writes files and journals: workers need no folder in common with it. A result
is asked for as soon as it is there, and then forgotten, since Dask makes a finished one again whose worker died while
somebody still wanted it. What was being made in a worker that died is given to another one. That there is no worker
at all is told.
"""

from __future__ import annotations

import logging
import pickle
import re
import signal
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any, NoReturn

import dask
from distributed import Client, KilledWorker, LocalCluster, Security, as_completed, get_worker

from culet.batch.absence import END_AFTER, Absence
from culet.batch.crew import Done, Item, More, Result, Task
from culet.batch.edition import edition
from culet.endpoints import is_loopback
from culet.errors import CuletError, InputError, WorkersError
from culet.rendering.opencl.processors import limit_threads_to

PATIENCE_SECONDS = 30
"""For the scheduler to answer, and for its first worker to come."""
LOOK_SECONDS = 1.0
"""Between looks whether there are workers, while no result comes."""
WAITING = 2
"""Items under way or waiting for each that is being made, so that no worker waits for this process."""
_ADDRESS = re.compile(r"(?P<way>\w+)://(?P<host>\[[0-9a-fA-F:]+\]|[^/:]+):(?P<port>\d{1,5})")


@dataclass(frozen=True)
class Certificates:
    """Files in PEM. What is missing is looked for in Dask's own configuration."""

    ca: Path | None = None
    """Whom both sides trust."""
    cert: Path | None = None
    """Of this client."""
    key: Path | None = None


Tell = Callable[[str], None]
"""Says a line to whoever waits."""
RESUMES = "the same command goes on where it was"
"""What becomes of work whose scheduler is lost, if it keeps a journal."""


def _untold(text: str) -> None: ...


@contextmanager
def local(count: int, tell: Tell = _untold, afterwards: str = RESUMES) -> Iterator[Cluster]:
    """So many workers on this machine, each with one thread and one processor; they end with the `with`.

    They and their scheduler speak by certificates that exist in memory alone: on a machine with several users none of
    the others reaches them. Ctrl-C is this process's alone, and a worker notices when this process is gone.
    """
    _quiet()
    before = _without_interrupts()
    try:
        cluster = LocalCluster(
            n_workers=count, threads_per_worker=1, security=True, memory_limit=0, silence_logs=logging.CRITICAL,
            dashboard_address=None, scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
        )  # fmt: skip
    except RuntimeError as error:  # as of one that is killed while it starts
        raise WorkersError(f"workers: {count} processes could not be started: {_reason(error)}") from error
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    with cluster, Client(cluster, set_as_default=False) as client:
        yield Cluster(client, "this command", tell, afterwards, END_AFTER)


@contextmanager
def remote(
    address: str, certificates: Certificates = Certificates(), tell: Tell = _untold, afterwards: str = RESUMES
) -> Iterator[Cluster]:
    """The workers of a scheduler; they outlive the `with`.

    InputError for an address that is none, or that other machines reach without being asked for a certificate;
    WorkersError if no scheduler answers there, if it has no workers, or if one of them is of another edition.
    """
    security = _security(address, certificates)
    _quiet()
    try:
        client = Client(address, security=security, timeout=PATIENCE_SECONDS, set_as_default=False)
    except (OSError, ValueError, RuntimeError) as error:
        raise WorkersError(f"scheduler: nothing that answers as one at {address}: {_reason(error)}") from error
    with client:
        found = Cluster(client, f"the scheduler at {address}", tell, afterwards)
        found.wait()
        yield found


class Cluster:
    """A crew of Dask's workers."""

    def __init__(self, client: Client, name: str, tell: Tell, afterwards: str, end_after: float | None = None) -> None:
        """It ends `end_after` so many s without a worker; without that never."""
        self._client, self._name, self._tell, self._afterwards = client, name, tell, afterwards
        self._absence = Absence(name, end_after)

    def wait(self) -> None:
        """Until there is a worker, all of them of this edition; WorkersError if there is not."""
        with self._naming():
            try:
                self._client.wait_for_workers(1, timeout=PATIENCE_SECONDS)
            except TimeoutError as error:
                raise WorkersError(f"workers: {self._name} has had none for {PATIENCE_SECONDS} s") from error
            self._check()

    @property
    def alone(self) -> bool:
        """However many workers there are at the time: they come and go."""
        return False

    def places(self) -> int:
        """Threads of all workers."""
        with self._naming():
            return sum(self._client.nthreads().values())

    def results(self, task: Task[Item, Result], more: More[Item]) -> Done[Item, Result]:
        """As they come. WorkersError if the scheduler is lost, if one item has killed several workers, or if there have
        been none for too long."""
        under_way = dict[str, Item]()
        with self._naming():
            # As the result of a task of its own each worker has it once, and it is made again if that worker dies.
            known = self._client.submit(pickle.loads, pickle.dumps(task), pure=False)
            done = as_completed(loop=self._client.loop, with_results=True, raise_errors=False)

        def fill() -> None:
            room = WAITING * max(1, self.places()) - len(under_way)
            for item in more(room) if room > 0 else ():
                future = self._client.submit(_perform, known, edition(), pickle.dumps(item), pure=False)
                under_way[future.key] = item
                done.add(future)

        with self._naming():
            fill()
        while self._waited(done):
            future, result = next(done)
            if future.status == "error":
                self._raise(future.exception())
            with self._naming():
                if isinstance(result, CancelledError):
                    raise result
                item = under_way.pop(future.key)
                future.release()
            yield item, result
            with self._naming():  # after that: who got it may have asked for more
                fill()

    def _waited(self, done: as_completed) -> bool:
        """Until a result is there; false if none will come. Tells if there are no workers."""
        looked = time.monotonic()
        while not done.has_ready():
            if done.is_empty():
                return False
            with done.thread_condition:
                done.thread_condition.wait(0.1)
            now = time.monotonic()
            if now - looked >= LOOK_SECONDS:
                looked = now
                with self._naming():
                    workers = self.places()
                self._say(self._absence.seen(now, workers))
        self._say(self._absence.seen(looked, 1))  # whoever made it
        return True

    def _say(self, text: str | None) -> None:
        if text is not None:
            self._tell(text)

    def _raise(self, error: BaseException) -> NoReturn:
        """What a piece of work has ended with."""
        if isinstance(error, KilledWorker):
            raise WorkersError(
                f"workers: {error.allowed_failures + 1} of them died at the same piece of work, which may need more "
                "memory than they have"
            ) from error
        if not isinstance(error, CuletError):
            with self._naming():
                self._check()  # what a worker of another edition cannot even read ends in any way
        raise error

    def _check(self) -> None:
        """WorkersError that names a worker of another edition."""
        for address, said in self._client.run(edition, on_error="return").items():
            if isinstance(said, OSError):  # it has gone meanwhile
                continue
            if said != edition():
                other = f"none that could be asked ({_reason(said)})" if isinstance(said, Exception) else said
                raise WorkersError(f"workers: expected culet {edition()} on each, got {other} on {address}")

    @contextmanager
    def _naming(self) -> Generator[None, None, None]:
        """What Dask raises when the scheduler is lost is told as such."""
        try:
            yield
        except (OSError, TimeoutError, CancelledError) as error:
            raise WorkersError(
                f"workers: {self._name} cannot be reached any more ({_reason(error)}); {self._afterwards}"
            ) from error


def _perform(task: Callable[[Any], Any], expected: str, item: bytes) -> Any:  # noqa: ANN401 - whatever the task gives
    """Runs in a worker, which is one renderer on as many processors as it has threads."""
    worker = get_worker()
    if edition() != expected:
        raise WorkersError(f"workers: expected culet {expected} on each, got {edition()} on {worker.address}")
    with _ONE_AT_A_TIME:
        limit_threads_to(worker.state.nthreads)
        return task(pickle.loads(item))  # noqa: S301 - of the client, whom the scheduler lets in by its certificate


_ONE_AT_A_TIME = threading.Lock()


def _security(address: str, certificates: Certificates) -> Security:
    parts = _ADDRESS.fullmatch(address)
    if parts is None or parts["way"] not in ("tls", "tcp"):
        raise InputError(f"scheduler: expected tls://HOST:PORT, got {address!r:.60}", "scheduler")
    if parts["way"] == "tcp":
        if not is_loopback(parts["host"]):
            raise InputError(
                f"scheduler: {address} would be neither encrypted nor closed to strangers, who could run any program "
                "on the workers; expected tls://HOST:PORT, or tcp:// of this machine, as tcp://127.0.0.1:8786",
                "scheduler",
            )
        return Security()
    named = {"tls_ca_file": certificates.ca, "tls_client_cert": certificates.cert, "tls_client_key": certificates.key}
    for option, file in (("tls-ca", certificates.ca), ("tls-cert", certificates.cert), ("tls-key", certificates.key)):
        if file is not None and not file.is_file():
            raise InputError(f"{option}: there is no file {file}", option)
    try:
        security = Security(
            require_encryption=True, **{name: str(file) for name, file in named.items() if file is not None}
        )
        context = security.get_connection_args("client").get("ssl_context")
    except (OSError, ValueError) as error:
        raise InputError(f"tls-cert: the certificates cannot be used: {_reason(error)}", "tls-cert") from error
    if context is None:
        raise InputError(
            "tls-ca: expected --tls-ca, --tls-cert and --tls-key for a scheduler by tls://, or Dask's own "
            "configuration of them (distributed.comm.tls), got none",
            "tls-ca",
        )
    return security


def _quiet() -> None:
    """Dask tells of each worker that comes and goes, amid the progress bar; what matters is raised. Nothing is served
    over http."""
    for name in [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    warnings.filterwarnings("ignore", message="Sending large graph", category=UserWarning)
    dask.config.set({
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
        "distributed.logging.distributed": "critical",
    })  # fmt: skip


def _without_interrupts() -> set[Any]:
    """Block Ctrl-C in this thread, and so in the threads and processes that are started from now on; the signals that
    were blocked before. The tracker of resources would let it through again when it is started."""
    resource_tracker.ensure_running()
    return signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _reason(error: object) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
