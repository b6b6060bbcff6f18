"""One file out of a multipart/form-data body (RFC 7578), counted while it comes and never put on disk."""

from __future__ import annotations

from collections.abc import AsyncIterable
from dataclasses import dataclass
from email.message import Message
from email.parser import HeaderParser

from culet.errors import InputError, TooLargeError

ENVELOPE_BYTES = 16 * 1024
"""Room for boundaries, part headers and small other fields around the file."""


@dataclass(frozen=True)
class UploadedFile:
    """A file's name as the sender has it, and its bytes."""

    name: str
    data: bytes


async def read_limited(chunks: AsyncIterable[bytes], limit: int) -> bytes:
    """All chunks as one; TooLargeError as soon as they are more than `limit` bytes plus the envelope."""
    body = bytearray()
    async for chunk in chunks:
        body += chunk
        if len(body) > limit + ENVELOPE_BYTES:
            raise TooLargeError(f"file: expected at most {limit} bytes, got more", "file")
    return bytes(body)


def uploaded_file(body: bytes, content_type: str | None, limit: int) -> UploadedFile:
    """The part named `file`; InputError if the body has no such part, TooLargeError if it is over `limit` bytes."""
    head = _header(f"Content-Type: {content_type}" if content_type else "")
    boundary = head.get_boundary()
    if head.get_content_type() != "multipart/form-data" or not boundary:
        raise InputError(f"expected multipart/form-data with a boundary, got {content_type}", "file")
    delimiter = b"\r\n--" + boundary.encode("latin-1", "replace")
    _preamble, *parts = (b"\r\n" + body).split(delimiter)
    if not parts or not parts[-1].startswith(b"--"):
        raise InputError("the form is cut off: its closing boundary is missing", "file")
    for part in parts[:-1]:
        headers, found, content = part.partition(b"\r\n\r\n")
        disposition = _header(headers.decode("utf-8", "replace").strip())
        if found and disposition.get_param("name", header="content-disposition") == "file":
            if len(content) > limit:
                raise TooLargeError(f"file: expected at most {limit} bytes, got {len(content)}", "file")
            return UploadedFile(disposition.get_filename() or "", content)
    raise InputError("expected a form field named file with the upload in it", "file")


def _header(text: str) -> Message:
    return HeaderParser().parsestr(text + "\r\n\r\n")
