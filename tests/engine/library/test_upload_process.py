"""Processes that read: what they may take, what they leave, and that the true cause is told."""

from __future__ import annotations

import asyncio
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from culet.engine.capacity.limits import Limits
from culet.engine.library import upload_process
from culet.engine.library.upload_answer import TooLittleMemoryError
from culet.engine.library.upload_process import ReadingRoom, read_upload
from culet.errors import InputError, MeshError, TooLargeError
from culet.optics.sky_files.picture import SkyPicture
from engine.peer import TETRAHEDRON
from optics.sky_files.writers import chunk

FULL = ReadingRoom(2**30, full=True)


def black_png(width: int, height: int) -> bytes:
    """A small file of many pixels."""
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    deflate = zlib.compressobj(9)
    row = bytes(1 + 3 * width)
    pixels = b"".join(deflate.compress(row) for _ in range(height)) + deflate.flush()
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


async def read_sky(data: bytes, file_type: str = "png", room: ReadingRoom = FULL, **limits: float) -> SkyPicture:
    sky = await read_upload("sky", InputError, file_type, data, Limits.read(limits), room)
    assert isinstance(sky, SkyPicture)
    return sky


async def test_a_sky_takes_little_more_to_read_than_to_keep() -> None:
    """4096 x 2048 pixels are 96 MiB; 8 times that before rows were decoded one after another."""
    sky = await read_sky(black_png(4096, 2048), room=ReadingRoom(145 * 2**20, full=False))
    assert sky.pixels.nbytes == 96 * 2**20
    with pytest.raises(TooLittleMemoryError) as refusal:
        await read_sky(black_png(4096, 2048), room=ReadingRoom(100 * 2**20, full=False))
    assert 96 * 2**20 < refusal.value.needed < 2 * 96 * 2**20


async def test_what_takes_more_memory_than_any_file_may_is_refused() -> None:
    with pytest.raises(InputError, match="the sky takes more than 64 MiB of memory to be read"):
        await read_sky(black_png(4096, 2048), room=ReadingRoom(2**26, full=True))


async def test_the_size_of_a_sky_is_a_setting() -> None:
    with pytest.raises(TooLargeError, match="at most 1000 pixels, got 64 x 32"):
        await read_sky(black_png(64, 32), max_sky_pixels=1000)


async def test_time_of_a_processor_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    spin = Path(__file__).with_name("spinning_reader.py")
    monkeypatch.setattr(upload_process, "PROGRAM", (str(spin),))
    with pytest.raises(MeshError, match=r"takes more than 1 s of processor time to be read"):
        await read_upload("mesh", MeshError, "off", TETRAHEDRON, Limits(read_processor_seconds=0.5), FULL)


async def test_a_reader_that_is_given_up_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    data = black_png(4096, 2048)
    with pytest.raises(InputError, match=r"could not be read in 0\.3 s"):
        await read_sky(data, read_seconds=0.3)
    reading = asyncio.create_task(read_sky(data))
    await asyncio.sleep(0)
    reading.cancel()
    with pytest.raises(asyncio.CancelledError):
        await reading
    assert next(os.scandir(tmp_path), None) is None


async def test_what_libraries_print_is_no_part_of_the_answer(tmp_path: Path) -> None:
    """OpenEXR warns on stdout of a file that was cut off."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": np.random.default_rng(1).random((64, 128, 3), np.float32)}).write(str(tmp_path / "a"))
    data = (tmp_path / "a").read_bytes()
    for part in (0.5, 0.99):
        with pytest.raises(InputError, match="damaged or cut off"):
            await read_sky(data[: int(part * len(data))], "exr")


async def test_a_full_disk_is_nothing_to_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", "/nowhere")
    assert (await read_sky(black_png(64, 32))).pixels.shape == (32, 64, 3)


async def test_the_reader_knows_nothing_of_its_parents_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(upload_process, "PROGRAM", (str(Path(__file__).with_name("telling_reader.py")),))
    monkeypatch.setenv("CULET_SECRET", "sesame")
    with pytest.raises(InputError, match="told: LC_CTYPE OPENBLAS_NUM_THREADS /") as told:
        await read_sky(b"")
    assert "SECRET" not in str(told.value)
