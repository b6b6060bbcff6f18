"""One file out of a multipart/form-data body (RFC 7578), parsed while it comes and never put on disk.

python-multipart parses in a thread of its own, some KiB at a time, so that the streams go on whatever the form's shape;
the number of parts and the length of their headers are bounded.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

from culet.errors import InputError, TooLargeError

ENVELOPE_BYTES = 16 * 1024
"""Room for boundaries, part headers and small other fields around the file."""
MAX_PARTS = 16
MAX_PART_HEADERS = 8
MAX_PART_HEADER_BYTES = 4096
"""Of one header; a path of the longest names that file systems have fits in."""
MAX_TYPE_BYTES = 1024
"""Of the body's Content-Type; a boundary has at most 70 characters (RFC 2046)."""
CHUNK_BYTES = 64 * 1024
"""Parsed at once: the thread holds the interpreter's lock for much of it."""

_THREAD = ThreadPoolExecutor(1, "forms")
"""One: several would share the lock with each other before the streams get it."""


@dataclass(frozen=True)
class UploadedFile:
    """A file's name as the sender has it, its bytes, and their SHA-256."""

    name: str
    data: bytes | bytearray = field(repr=False)
    digest: bytes


async def read_form(chunks: AsyncIterable[bytes], content_type: str | None, limit: int) -> UploadedFile:
    """The part named `file` of a form that comes in chunks.

    InputError if there is none or what comes is no form, TooLargeError as soon as the file is over `limit` bytes, or
    all of the form over that and the envelope.
    """
    form, came = Form(content_type, limit), 0
    loop = asyncio.get_running_loop()
    try:
        async for chunk in chunks:
            came += len(chunk)
            if came > limit + ENVELOPE_BYTES:
                raise TooLargeError(f"file: expected at most {limit} bytes, got more", "file")
            for at in range(0, len(chunk), CHUNK_BYTES):
                await loop.run_in_executor(_THREAD, form.write, chunk[at : at + CHUNK_BYTES])
        return form.file()
    finally:
        form.forget()


class Form:
    """A form that is being parsed; only its first part named `file` is kept."""

    def __init__(self, content_type: str | None, limit: int) -> None:
        """`content_type` is the body's; InputError unless it is a form's."""
        kind, options = parse_options_header(content_type) if len(content_type or "") <= MAX_TYPE_BYTES else (b"", {})
        wanted = f"expected multipart/form-data with a boundary, got {(content_type or 'no content type')[:200]}"
        if kind != b"multipart/form-data" or not options.get(b"boundary"):
            raise InputError(wanted, "file")
        self._limit = limit
        self._name: str | None = None
        self._data = bytearray()
        self._digest = hashlib.sha256()
        self._parts = 0
        self._field, self._value = bytearray(), bytearray()
        self._disposition: bytes | None = None
        self._taking = self._ended = False
        try:
            self._parser = MultipartParser(
                options[b"boundary"],
                {
                    "on_part_begin": self._on_part_begin,
                    "on_header_field": self._on_header_field,
                    "on_header_value": self._on_header_value,
                    "on_header_end": self._on_header_end,
                    "on_headers_finished": self._on_headers_finished,
                    "on_part_data": self._on_part_data,
                    "on_end": self._on_end,
                },
                max_header_count=MAX_PART_HEADERS,
                max_header_size=MAX_PART_HEADER_BYTES,
            )
        except FormParserError as error:
            raise InputError(f"{wanted}: {error}", "file") from error

    def write(self, chunk: bytes) -> None:
        """The next bytes of the body; InputError, TooLargeError."""
        if self._ended:  # what follows the closing boundary means nothing
            return
        try:
            self._parser.write(chunk)
        except FormParserError as error:
            raise InputError(f"file: expected a form as multipart/form-data: {error}", "file") from error

    def file(self) -> UploadedFile:
        """The file, once all has come; InputError if there is none."""
        if not self._ended:
            raise InputError("file: the form is cut off: its closing boundary is missing", "file")
        if self._name is None:
            raise InputError("file: expected a form field named file with the upload in it", "file")
        return UploadedFile(self._name, self._data, self._digest.digest())

    def forget(self) -> None:
        """Let go of what was kept: the parser and this know each other, and would hold it until the next collection."""
        self._data = bytearray()

    def _on_part_begin(self) -> None:
        self._parts += 1
        if self._parts > MAX_PARTS:
            raise InputError(f"file: expected a form of at most {MAX_PARTS} parts, got more", "file")
        self._disposition, self._taking = None, False

    def _on_header_field(self, data: bytes, start: int, end: int) -> None:
        self._field += data[start:end]

    def _on_header_value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]

    def _on_header_end(self) -> None:
        if self._field.lower() == b"content-disposition":
            self._disposition = bytes(self._value)
        self._field.clear()
        self._value.clear()

    def _on_headers_finished(self) -> None:
        _, options = parse_options_header(self._disposition)
        if self._name is None and options.get(b"name") == b"file":
            self._name = options.get(b"filename", b"").decode("utf-8", "replace")
            self._taking = True

    def _on_part_data(self, data: bytes, start: int, end: int) -> None:
        if not self._taking:
            return
        part = memoryview(data)[start:end]
        if len(self._data) + len(part) > self._limit:
            raise TooLargeError(f"file: expected at most {self._limit} bytes, got more", "file")
        self._data += part
        self._digest.update(part)

    def _on_end(self) -> None:
        self._ended = True
