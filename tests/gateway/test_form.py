"""Files in forms, as browsers and curl send them."""

from __future__ import annotations

from collections.abc import AsyncIterator

import pytest

from culet.errors import InputError, TooLargeError
from culet.gateway.form import ENVELOPE_BYTES, UploadedFile, read_limited, uploaded_file

TYPE = "multipart/form-data; boundary=XX"


def form(name: str, data: bytes, field: str = "file") -> bytes:
    head = f'--XX\r\nContent-Disposition: form-data; name="{field}"; filename="{name}"\r\nContent-Type: a/b\r\n\r\n'
    return head.encode() + data + b"\r\n--XX--\r\n"


@pytest.mark.parametrize("data", [b"", b"\r\n", b"\r\n--X", b"\0\xff\r\n\r\n\n", bytes(range(256))])
def test_every_byte_of_the_file_arrives(data: bytes) -> None:
    assert uploaded_file(form("a.stl", data), TYPE, 1000) == UploadedFile("a.stl", data)


def test_other_fields_around_the_file_do_not_matter() -> None:
    note = b'--XX\r\nContent-Disposition: form-data; name="note"\r\n\r\nhello\r\n'
    assert uploaded_file(note + form("ö b.obj", b"v"), TYPE, 10) == UploadedFile("ö b.obj", b"v")


@pytest.mark.parametrize(
    ("body", "content_type", "message"),
    [
        (form("a", b"x"), None, "expected multipart/form-data"),
        (form("a", b"x"), "application/json", "expected multipart/form-data"),
        (form("a", b"x"), "multipart/form-data", "expected multipart/form-data with a boundary"),
        (form("a", b"x")[:-6], TYPE, "cut off"),
        (b"", TYPE, "cut off"),
        (form("a", b"x", field="mesh"), TYPE, "a form field named file"),
    ],
)
def test_what_is_not_such_a_form_is_refused(body: bytes, content_type: str | None, message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        uploaded_file(body, content_type, 10)
    assert refused.value.field == "file"


def test_a_file_of_the_limit_is_taken_and_a_byte_more_is_not() -> None:
    assert len(uploaded_file(form("a", b"x" * 100), TYPE, 100).data) == 100
    with pytest.raises(TooLargeError, match="at most 100 bytes, got 101"):
        uploaded_file(form("a", b"x" * 101), TYPE, 100)


async def test_reading_stops_as_soon_as_there_is_too_much() -> None:
    taken = 0

    async def endless() -> AsyncIterator[bytes]:
        nonlocal taken
        while True:
            taken += 1000
            yield bytes(1000)

    with pytest.raises(TooLargeError):
        await read_limited(endless(), 5000)
    assert taken <= 5000 + ENVELOPE_BYTES + 1000
