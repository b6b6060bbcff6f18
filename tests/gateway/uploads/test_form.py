"""Files in forms, as browsers and curl send them, and what is no such form, in any shape."""

from __future__ import annotations

import asyncio
import gc
import hashlib
import time
import tracemalloc
from collections.abc import AsyncIterator

import pytest

from culet.errors import InputError, TooLargeError
from culet.gateway.uploads.form import ENVELOPE_BYTES, MAX_PARTS, UploadedFile, read_form

TYPE = "multipart/form-data; boundary=XX"
MEBIBYTE = 1 << 20


def form(name: str, data: bytes, field: str = "file") -> bytes:
    head = f'--XX\r\nContent-Disposition: form-data; name="{field}"; filename="{name}"\r\nContent-Type: a/b\r\n\r\n'
    return head.encode() + data + b"\r\n--XX--\r\n"


async def read(body: bytes, content_type: str | None = TYPE, limit: int = 1000, chunk: int = 1 << 16) -> UploadedFile:
    """As it is read from a connection."""

    async def chunks() -> AsyncIterator[bytes]:
        for at in range(0, len(body), chunk):
            yield body[at : at + chunk]

    return await read_form(chunks(), content_type, limit)


@pytest.mark.parametrize("chunk", [1, 7, 1000])
@pytest.mark.parametrize("data", [b"", b"\r\n", b"\r\n--X", b"\0\xff\r\n\r\n\n", bytes(range(256))])
async def test_every_byte_of_the_file_arrives_however_it_is_cut(data: bytes, chunk: int) -> None:
    file = await read(form("a.stl", data), chunk=chunk)
    assert (file.name, bytes(file.data), file.digest) == ("a.stl", data, hashlib.sha256(data).digest())


async def test_other_fields_around_the_file_do_not_matter() -> None:
    note = b'--XX\r\nContent-Disposition: form-data; name="note"\r\n\r\nhello\r\n'
    file = await read(note + form("ö b.obj", b"v"))
    assert (file.name, bytes(file.data)) == ("ö b.obj", b"v")


@pytest.mark.parametrize(
    ("body", "content_type", "message"),
    [
        (form("a", b"x"), None, "expected multipart/form-data with a boundary, got no content type"),
        (form("a", b"x"), "application/json", "expected multipart/form-data"),
        (form("a", b"x"), "multipart/form-data", "expected multipart/form-data with a boundary"),
        (form("a", b"x"), "multipart/form-data; boundary=" + "X" * 60_000, "expected multipart/form-data"),
        (form("a", b"x"), "multipart/form-data; " + "x=x;" * 15_000, "expected multipart/form-data"),
        (form("a", b"x")[:-6], TYPE, "cut off"),
        (b"", TYPE, "cut off"),
        (form("a", b"x", field="mesh"), TYPE, "a form field named file"),
        (b"\r\n--XX" * 1000, TYPE, "expected a form as multipart/form-data"),
        (b"--XX\r\na: b\r\n\r\n\r\n" * (MAX_PARTS + 1) + b"--XX--", TYPE, f"at most {MAX_PARTS} parts"),
        (b"--XX\r\n" + b"x: y\r\n" * 1000 + b"\r\n\r\n--XX--", TYPE, "Maximum header count"),
        (b"--XX\r\nContent-Disposition: form-data" + b"; name=x" * 1000 + b"\r\n\r\n\r\n--XX--", TYPE, "header size"),
        (b"{}", TYPE, "expected a form as multipart/form-data"),
    ],
)
async def test_what_is_not_such_a_form_is_refused(body: bytes, content_type: str | None, message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        await read(body, content_type, limit=100_000)
    assert refused.value.field == "file"
    assert len(str(refused.value)) < 500


async def test_a_file_of_the_limit_is_taken_and_a_byte_more_is_not() -> None:
    assert len((await read(form("a", b"x" * 100), limit=100)).data) == 100
    with pytest.raises(TooLargeError, match="at most 100 bytes, got more"):
        await read(form("a", b"x" * 101), limit=100)


async def test_nothing_of_a_form_that_was_broken_off_is_kept() -> None:
    """A collection of garbage may be long in coming."""

    async def broken_off() -> AsyncIterator[bytes]:
        yield form("a.obj", b"x" * (8 * MEBIBYTE))[:-100]
        raise ConnectionResetError

    gc.collect()
    gc.disable()
    tracemalloc.start()
    try:
        with pytest.raises(ConnectionResetError):
            await read_form(broken_off(), TYPE, 9 * MEBIBYTE)
        assert tracemalloc.get_traced_memory()[0] < MEBIBYTE
        assert tracemalloc.get_traced_memory()[1] > 8 * MEBIBYTE
    finally:
        tracemalloc.stop()
        gc.enable()


async def test_reading_stops_as_soon_as_there_is_too_much() -> None:
    taken = 0

    async def endless() -> AsyncIterator[bytes]:
        nonlocal taken
        yield b"--XX\r\n\r\n"
        while True:
            taken += 1000
            yield bytes(1000)

    with pytest.raises(TooLargeError):
        await read_form(endless(), TYPE, 5000)
    assert taken <= 5000 + ENVELOPE_BYTES + 1000


@pytest.mark.parametrize(
    "body",
    [
        b"--XX\r\n\r\n" + b"\r\n--X" * (4 * MEBIBYTE // 5),
        b"--XX\r\n\r\n" + b"\r" * (4 * MEBIBYTE),
        form("a.obj", b"\n" * (4 * MEBIBYTE)),
    ],
    ids=["almost boundaries", "carriage returns", "a file"],
)
async def test_the_loop_goes_on_while_a_form_is_parsed(body: bytes) -> None:
    """Turns of the loop come between any two chunks; parsed on the loop there would be one for each form."""
    turns, running = 0, True

    async def turn() -> None:
        nonlocal turns
        while running:
            turns += 1
            await asyncio.sleep(0)

    turning = asyncio.create_task(turn())
    began = time.process_time()
    try:
        await read(body, limit=8 * MEBIBYTE, chunk=len(body))
    except InputError:
        pass
    finally:
        running = False
        await turning
    assert turns > len(body) / (1 << 16), f"in {time.process_time() - began:.2f} s of processor time"
