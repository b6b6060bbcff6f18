"""WebSocket frames by hand, so that they can be wrong."""

from __future__ import annotations

import base64
import contextlib
import os
import random
import socket
import struct

from culet_protocol import SUBPROTOCOL
from shared import patience

PATIENCE = patience.PATIENCE


def opened(port: int, session: str) -> socket.socket:
    """A connection after its handshake."""
    one = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
    key = base64.b64encode(os.urandom(16)).decode()
    one.sendall(
        f"GET /api/sessions/{session}/stream HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
        f"Sec-WebSocket-Protocol: {SUBPROTOCOL}\r\n\r\n".encode()
    )
    head = b""
    while b"\r\n\r\n" not in head:
        head += one.recv(1)
    assert head.startswith(b"HTTP/1.1 101"), head
    return one


def packed(payload: bytes, opcode: int, *, final: bool, masked: bool, reserved: int, length: int | None) -> bytes:
    """A frame of RFC 6455, 5.2, whether it makes sense or not."""
    said = len(payload) if length is None else length
    head = bytes([(final << 7) | (reserved << 4) | opcode])
    mask = 0x80 if masked else 0
    if said < 126:
        head += bytes([mask | said])
    elif said < 1 << 16:
        head += bytes([mask | 126]) + struct.pack(">H", said)
    else:
        head += bytes([mask | 127]) + struct.pack(">Q", said)
    if not masked:
        return head + payload
    key = os.urandom(4)
    return head + key + bytes(byte ^ key[n % 4] for n, byte in enumerate(payload))


def malformed(dice: random.Random) -> bytes:
    """A frame that no client sends."""
    payload = dice.choice((b"", b"x", b'{"type":"ping","time":1}', b"\xff\xfe\xfd", b"[" * 5000, os.urandom(200)))
    return packed(
        payload,
        dice.choice((0, 1, 2, 3, 7, 8, 9, 10, 11, 15)),
        final=dice.random() < 0.6,
        masked=dice.random() < 0.7,
        reserved=dice.choice((0, 0, 1, 4, 7)),
        length=dice.choice((None, None, 0, 126, 70_000, 2**31, 2**62)),
    )


def close_code(one: socket.socket) -> int | None:
    """What the server closes with; none if it keeps the connection or drops it without a word."""
    one.settimeout(1)
    data = b""
    with contextlib.suppress(TimeoutError, OSError):
        while len(data) < 1 << 22 and (more := one.recv(1 << 16)):
            data += more
    at = 0
    while at + 2 <= len(data):  # a server's frames are not masked
        opcode, length = data[at] & 15, data[at + 1] & 127
        at += 2
        if length >= 126:
            size = 2 if length == 126 else 8
            length = int.from_bytes(data[at : at + size])
            at += size
        if opcode == 8:
            return int.from_bytes(data[at : at + 2])
        at += length
    return None
