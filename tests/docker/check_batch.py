"""What must be had from scheduler, workers and client in containers, though one is killed.

`make compose-test` calls this:

PYTHONPATH=tests python -m docker.check_batch FOLDER docker compose --file docker/compose.yaml --profile batch

FOLDER is CULET_BATCH_CERTIFICATES; results go to the folder `out` beside it.
"""

from __future__ import annotations

import argparse
import asyncio
import subprocess
from pathlib import Path

from batch.workers import numbers_in
from docker.claims import check, until
from docker.confinement import check_confined
from docker.containers import CommandError, Containers

FRAMES = 120
ANIMATE = (
    "culet", "animate", "--turntable", "--seconds", f"{FRAMES / 10:g}", "--fps", "10",
    "--width", "192", "--height", "108", "--samples", "4",
)  # fmt: skip
PATIENCE = 300.0
"""Seconds for what takes some twenty."""


def certificates(folder: Path, names: tuple[str, str]) -> None:
    """An authority and a certificate, as docs/how-to/batch.md makes them; readable, since they are of no use later."""
    authority, own = names
    for command in (
        f"req -x509 -newkey rsa:3072 -nodes -days 2 -subj /CN={authority} -keyout {authority}.key -out {authority}.pem",
        f"req -newkey rsa:3072 -nodes -subj /CN=worker -keyout {own}.key -out {own}.csr",
        f"x509 -req -in {own}.csr -CA {authority}.pem -CAkey {authority}.key -CAcreateserial -days 2 -out {own}.pem",
    ):
        subprocess.run(["openssl", *command.split()], cwd=folder, check=True, capture_output=True)
    for file in folder.iterdir():
        file.chmod(0o644)
    folder.chmod(0o755)


class Batch:
    """The containers, and where results go."""

    def __init__(self, containers: Containers, out: Path) -> None:
        self.containers = containers
        self.out = out
        out.mkdir(exist_ok=True)
        out.chmod(0o777)

    async def run(self, *command: str, fails: str | None = None) -> str:
        """What a command says in a container of `client`; `fails` is what it must say if it has to fail."""
        return await self.containers.compose(
            "run", "--rm", "--no-TTY", "--volume", f"{self.out}:/out", "client", *command, fails=fails
        )

    def pictures(self, name: str) -> dict[str, bytes]:
        """The frames in a folder, by their names."""
        return {file.name: file.read_bytes() for file in sorted((self.out / name).glob("*.png"))}


async def check_killed_worker(batch: Batch) -> None:
    """Every frame is made once, and is what one process makes of it."""
    print("a worker's container is killed while frames are made", flush=True)
    folder = batch.out / "workers"
    making = asyncio.create_task(batch.run(*ANIMATE, "-o", "/out/workers", "--scheduler", "tls://scheduler:8786"))

    async def some() -> bool:
        if making.done():
            await making
        return len(numbers_in(folder)) >= 5

    await until("frames come", some, PATIENCE)
    worker, *_ = await batch.containers.all("worker")
    await worker.kill()
    check(0 < len(numbers_in(folder)) < FRAMES, f"it was killed after {len(numbers_in(folder))} frames of {FRAMES}")
    said = await making
    check(f"{FRAMES} frames of 192 x 108" in said, f"the command ends: {said.strip()}")
    check(sorted(numbers_in(folder)) == list(range(FRAMES)), "each frame was made once")
    await batch.run(*ANIMATE, "-o", "/out/alone")
    alone, shared = batch.pictures("alone"), batch.pictures("workers")
    check(len(alone) == FRAMES and alone == shared, "they are what one process makes, to the last bit")
    await worker.start()


async def check_strangers(batch: Batch, folder: Path) -> None:
    """Whoever has another certificate has no work done."""
    certificates(folder, ("strange", "other"))
    tls = [
        word
        for option, file in (("ca", "strange.pem"), ("cert", "other.pem"), ("key", "other.key"))
        for word in (f"--tls-{option}", f"/certificates/{file}")
    ]
    to = ("-o", "/out/strange", "--scheduler")
    await batch.run(*ANIMATE, *to, "tls://scheduler:8786", *tls, fails="nothing that answers as one at")
    check(True, "a stranger's certificate is refused")
    await batch.run(*ANIMATE, *to, "tcp://scheduler:8786", fails="would be neither encrypted nor closed to strangers")
    check(True, "without encryption nothing is asked for")


async def main() -> None:
    """Ask for everything, in order."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path, help="for certificates: CULET_BATCH_CERTIFICATES")
    parser.add_argument("compose", nargs=argparse.REMAINDER, help="docker compose, with what names the project")
    arguments = parser.parse_args()
    containers = Containers(arguments.compose)
    folder: Path = arguments.folder
    certificates(folder, ("ca", "own"))
    batch = Batch(containers, folder.parent / "out")
    try:
        print("a scheduler and two workers are started", flush=True)
        await containers.compose("up", "--detach", "--wait", "--scale", "worker=2", "scheduler", "worker")
        check(True, "the scheduler greets whoever has the certificate")
        for service, number in (("scheduler", 1), ("worker", 2)):
            found = await containers.all(service)
            check(len(found) == number, f"there are {number} of {service}")
            for each in found:
                await check_confined(each, service)
        await check_killed_worker(batch)
        await check_strangers(batch, folder)
    finally:
        try:
            await batch.run("chmod", "-R", "a+rwX", "/out/workers", "/out/alone")  # whose files are another user's
        except CommandError:
            print(f"{batch.out} could not be made removable", flush=True)


if __name__ == "__main__":
    asyncio.run(main())
