"""A process that reads one upload and ends, from the engine's side: what it may take, and why it failed."""

from __future__ import annotations

import asyncio
import contextlib
import math
import os
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from culet.engine.capacity.limits import Limits
from culet.engine.library.upload_answer import AnswerError, TooLittleMemoryError, taken
from culet.engine.library.upload_reader import NAME, ReadingOrder
from culet.errors import InputError
from culet.geometry.shape import Shape
from culet.memory_file import memory_file
from culet.optics.sky_files.picture import SkyPicture

PROGRAM = ("-m", NAME)
"""What the process runs; isolated from the user's own packages and from the folder that it is started in."""
ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}
"""All that the process gets of one: nothing of the engine's."""
Buffer = bytes | bytearray | memoryview
"""Bytes of a file."""
COMPLAINT_BYTES = 4096
"""Of what it printed last, which may say why it ended."""
BYTES_PER_PIXEL = 12
"""Of a sky that is kept: three of float32."""


@dataclass(frozen=True)
class ReadingRoom:
    """What reading may take."""

    memory: int
    """Bytes, besides those of a program that has read nothing."""
    full: bool
    """It is as much as any upload may take, and not just what is free at the moment."""


async def read_upload(
    kind: str, error: type[InputError], file_type: str, data: Buffer, limits: Limits, room: ReadingRoom
) -> Shape | SkyPicture:
    """What the file holds. InputError (of that type, if there is no better one) says what is wrong with it;
    TooLittleMemoryError, that the room was too little, which is not all that a file may take."""
    with _descriptor("upload") as upload, _descriptor("answer") as answer, _descriptor("complaint") as complaint:
        await asyncio.to_thread(_fill, os.dup(upload), data)  # a pipe would be filled by the loop
        order = ReadingOrder(
            kind, file_type, answer, limits.max_mesh_triangles, limits.max_sky_pixels, room.memory,
            math.ceil(limits.read_processor_seconds),
            max(BYTES_PER_PIXEL * limits.max_sky_pixels + 2**21, 2 * limits.max_upload_bytes),
        )  # fmt: skip
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-I", *PROGRAM, *order.words(),
            stdin=upload, stdout=complaint, stderr=complaint, pass_fds=(answer,),
            env=ENVIRONMENT, cwd="/", start_new_session=True,
        )  # fmt: skip
        try:
            async with asyncio.timeout(limits.read_seconds):
                await process.wait()
        except TimeoutError:
            raise error(f"the {kind} could not be read in {limits.read_seconds:g} s", "file") from None
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # and whatever it started
            await process.wait()
        if process.returncode != 0:
            raise _ended(kind, error, process.returncode or 0, _last_line(complaint), limits, room)
        try:
            return await asyncio.to_thread(taken, answer, kind)
        except TooLittleMemoryError as fault:
            raise _too_large(kind, error, room, fault.needed) from None
        except AnswerError as fault:
            raise error(f"the process that read the {kind} gave no usable answer: {fault}", "file") from fault


def _ended(kind: str, error: type[InputError], code: int, last: str, limits: Limits, room: ReadingRoom) -> Exception:
    """Why a process ended without an answer."""
    if code == -signal.SIGXCPU or (code == -signal.SIGKILL and not last):
        seconds = math.ceil(limits.read_processor_seconds)
        return error(f"the {kind} takes more than {seconds} s of processor time to be read", "file")
    if "MemoryError" in last or "bad_alloc" in last or "llocate" in last:
        return _too_large(kind, error, room, 0)
    if code == -signal.SIGXFSZ:
        return error(f"the {kind} is larger than what may be kept", "file")
    return error(f"the {kind} ended the process that read it: {last or f'exit code {code}'}", "file")


def _too_large(kind: str, error: type[InputError], room: ReadingRoom, needed: int) -> Exception:
    if room.full:
        return error(f"the {kind} takes more than {room.memory / 2**20:.0f} MiB of memory to be read", "file")
    return TooLittleMemoryError(needed)


def _last_line(descriptor: int) -> str:
    size = os.fstat(descriptor).st_size
    said = os.pread(descriptor, COMPLAINT_BYTES, max(0, size - COMPLAINT_BYTES))
    return said.decode(errors="replace").strip().rpartition("\n")[2][:200]


def _fill(descriptor: int, data: Buffer) -> None:
    """Write all of it, to be read from its beginning, and close the descriptor: nobody may wait for that any more."""
    with os.fdopen(descriptor, "wb", buffering=0) as file:
        rest = memoryview(data)
        while rest:
            rest = rest[file.write(rest) :]
        file.seek(0)


@contextlib.contextmanager
def _descriptor(name: str) -> Iterator[int]:
    descriptor = memory_file(name)
    try:
        yield descriptor
    finally:
        os.close(descriptor)
