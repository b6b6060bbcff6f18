"""`python -m hostile.forms PORT SHAPE MIB`: sends an upload form of that shape and size; prints the answer's status.

In a process of its own, so that it holds up nobody's loop but the server's.
"""

from __future__ import annotations

import contextlib
import socket
import sys
from collections.abc import Callable, Mapping

from hostile.serving import MIB
from shared import patience

TYPE = "multipart/form-data; boundary=a"
FILE = b'--a\r\nContent-Disposition: form-data; name="file"; filename="sky.png"\r\n\r\n'
END = b"\r\n--a--\r\n"
PATIENCE = patience.PATIENCE
AT_ONCE = MIB
"""Bytes."""


def file_of(piece: bytes) -> Callable[[int], bytes]:
    """A form with a file that is nothing but that."""
    return lambda size: FILE + piece * ((size - len(FILE) - len(END)) // len(piece)) + END


def chunked(body: bytes) -> bytes:
    """The body in chunks of one byte (RFC 9112, 7.1)."""
    return b"".join(b"1\r\n%c\r\n" % byte for byte in body) + b"0\r\n\r\n"


SHAPES: Mapping[str, Callable[[int], bytes]] = {
    "empty parts": lambda size: b"\r\n--a" * (size // 5) + b"--",
    "one file": file_of(b"\x89PNG\r\n\x1a\n and then something else, for long"),
    "line breaks": file_of(b"\r\n"),
    "near-boundaries": file_of(b"\r\n--"),
    "chunks of one byte": lambda size: chunked(file_of(b"x")(size // 6)),
}


def send(port: int, shape: str, mebibytes: int) -> int:
    """The status of the answer; 0 if there was none."""
    body = SHAPES[shape](mebibytes * MIB - 1024)
    length = "Transfer-Encoding: chunked" if shape.startswith("chunks") else f"Content-Length: {len(body)}"
    head = f"POST /api/skies HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: {TYPE}\r\n{length}\r\n\r\n".encode()
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as one:
        with contextlib.suppress(OSError):  # it may be answered before its end
            for at in range(0, len(body), AT_ONCE):
                one.sendall((head if at == 0 else b"") + body[at : at + AT_ONCE])
        with contextlib.suppress(OSError):
            return int(one.recv(AT_ONCE).split()[1])
    return 0


if __name__ == "__main__":
    print(send(int(sys.argv[1]), sys.argv[2], int(sys.argv[3])))
