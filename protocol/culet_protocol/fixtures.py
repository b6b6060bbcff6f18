"""Golden bytes and messages, read by the tests of every language: `python -m culet_protocol.fixtures` writes them.

`frames.json` lists the binary messages beside it: what a reader must find in each, or what it must complain about.
`messages.json` holds one message of each type, and messages that must be refused.
"""

from __future__ import annotations

import base64
import json
import math
import struct
import zlib
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from culet_protocol import VERSION, messages
from culet_protocol.frame import HEADER_SIZE, Codec, Flags, Frame
from culet_protocol.watch import watch_id

FIXTURES = Path(__file__).resolve().parent.parent / "fixtures"

JPEG = base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAA0JCgsKCA0LCgsODg0PEyAVExISEyccHhcgLikxMC4pLSwzOko+MzZGNywtQFdBRkxOUlNSMj5aYVpQ"
    "YEpRUk//2wBDAQ4ODhMREyYVFSZPNS01T09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT09PT0//wAARCAAIABAD"
    "ASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAAAAT/xAAUEAEAAAAAAAAAAAAAAAAAAAAA/8QAFAEBAAAAAAAAAAAAAAAAAAAABf/EABkRAAID"
    "AQAAAAAAAAAAAAAAAAAGQ4HBgv/aAAwDAQACEQMRAD8AgSgRXZK0VZYusP/Z"
)
"""16 x 8 pixels, the left half red, the right half blue."""


DELTA = bytes.fromhex("00000001419a26216fd62e2d3c1afb9e712fe62496f820ee9ac2cc227aad5f49e6b8")
"""The first bytes of a frame of video that needs the one before it."""


def _png(width: int, height: int, rgb: bytes) -> bytes:
    """A PNG with stored (uncompressed) data: the same bytes whatever the version of zlib."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + rgb * width) * height
    stored = b"\x78\x01\x01" + struct.pack("<HH", len(rows), len(rows) ^ 0xFFFF) + rows
    stored += struct.pack(">I", zlib.adler32(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", stored) + chunk(b"IEND", b"")


# Fractions are sums of powers of two, so that float32 keeps them and every language prints them alike.
MOVING = Frame(
    watch=bytes(range(16)), codec=Codec.JPEG, flags=Flags.MOVING | Flags.FRONTIER, sequence=7, depends_on=6, width=16,
    height=8,
    samples=1, bands=3, max_bounces=256, cutoff=0.015625, step=42, simulation_time=1.4375, timestamp=1_760_000_000.5,
    simulate_ms=0.125, render_ms=31.5, encode_ms=1.75, cut=0.03125, error=0.0625, payload=JPEG,
    light_cut=0.125, light_error=0.0078125,
)  # fmt: skip
STILL = Frame(
    watch=bytes(range(240, 256)), codec=Codec.PNG,
    flags=Flags.KEY | Flags.FINAL | Flags.POLARISED | Flags.BELOW | Flags.RIGHT, sequence=0xFFFFFFFF, width=4, height=2,
    samples=1024, bands=64, max_bounces=65536, cutoff=2**-20, step=2**53 + 1, simulation_time=0,
    timestamp=1_760_000_000.25, simulate_ms=0, render_ms=2048.5, encode_ms=18.25, cut=0, error=0.015625,
    payload=_png(4, 2, b"\x10\x80\xf0"), light_cut=0, light_error=0.001953125,
    shown_error=0.00390625, rest_error=0.005859375,
)  # fmt: skip
"""Its sequence is the last before it wraps; its step is the first integer that a double cannot hold."""


def _with(frame: Frame, field: str, value: bytes | int) -> bytes:
    """The frame's bytes with one field of the header overwritten."""
    packed = frame.pack()
    offset, form = {"magic": (16, "4s"), "version": (20, "B"), "codec": (21, "B"), "length": (109, "I")}[field]
    return packed[:offset] + struct.pack("<" + form, value) + packed[offset + struct.calcsize(form) :]


def frames() -> dict[str, tuple[bytes, dict[str, Any]]]:
    """Name -> (message, what a reader must find: `fields`, or the `expected` and `got` that its complaint names)."""
    valid = {
        "jpeg": MOVING,
        "png": STILL,
        "h264": replace(MOVING, codec=Codec.H264, payload=DELTA, sequence=9, depends_on=8),
        "empty_payload": replace(MOVING, payload=b"", sequence=8, flags=Flags.NONE, error=math.nan),
    }
    size, marked = HEADER_SIZE, MOVING.pack()
    refused = {
        "empty": (b"", f"{size} bytes", "0"),
        "truncated_header": (marked[: size - 1], f"{size} bytes", f"{size - 1}"),
        "truncated_payload": (marked[:-1], f"{len(JPEG)} bytes", f"{len(JPEG) - 1}"),
        "trailing_byte": (marked + b"\0", f"{len(JPEG)} bytes", f"{len(JPEG) + 1}"),
        "wrong_magic": (_with(MOVING, "magic", b"NOPE"), "CULT", "NOPE"),
        "wrong_version": (_with(MOVING, "version", 3), "version 6", "3"),
        "wrong_codec": (_with(MOVING, "codec", 9), "1 (JPEG)", "9"),
        "wrong_length": (_with(MOVING, "length", 5), "5 bytes", f"{len(JPEG)}"),
    }
    found = {name: (frame.pack(), {"fields": _fields(frame)}) for name, frame in valid.items()}
    complaints = {name: (data, {"expected": wanted, "got": got}) for name, (data, wanted, got) in refused.items()}
    return {**found, **complaints}


def _fields(frame: Frame) -> dict[str, Any]:
    values = {field.name: getattr(frame, field.name) for field in fields(frame)}
    values["watch"] = frame.watch.hex()
    values["step"] = str(frame.step)  # JSON readers turn numbers into doubles
    values["payload"] = len(frame.payload)
    # JSON has no NaN.
    return {name: None if isinstance(value, float) and math.isnan(value) else value for name, value in values.items()}


CONTROL_EVENTS: tuple[messages.Message, ...] = (
    messages.Orbit(target="camera", yaw=0.25, pitch=-0.125),
    messages.Translate(target="light_1", right=0.5, up=-0.5),
    messages.Dolly(target="light_2", forward=0.5),
    messages.ResetCamera(),
    messages.LookAtStone(),
    messages.LookAtStone(stone="ruby"),
    messages.ToggleFall(),
    messages.ToggleFall(stone="ruby"),
    messages.ResetStone(),
    messages.ResetStone(stone="stone-2"),
    messages.Push(x=0.25, y=-0.125, right=0.5, up=1.5),
    messages.MoveStone(stone="ruby", right=0.25, up=-0.5, forward=1),
    messages.DragStone(stone="ruby", right=0.125, up=-0.25),
    messages.TurnStone(stone="ruby", yaw=0.25, pitch=-0.125, roll=0.5),
    messages.ToggleMirror(),
    messages.ToggleEnvironment(),
    messages.ToggleWalls(),
    messages.PatchScene(patch={"camera": {"fov_degrees": 30}}),
    messages.SetScene(scene={}),
    messages.Undo(),
    messages.Redo(),
    messages.Balance(exactness=0.75, pinned=True),
    messages.Pick(number=3, x=0.25, y=-0.125),
    messages.Outline(stone="stone", step=42),
    messages.Reach(number=4),
    messages.Resize(width=1280, height=720),
    messages.Visibility(visible=False),
    messages.Ack(sequence=7),
    messages.Decoders(codecs=("h264", "vp9")),
    messages.Ping(time=1234.5),
)

NOTICES: tuple[messages.Message, ...] = (
    messages.Hello(
        protocol=VERSION,
        session=bytes(range(16)).hex(),
        watch=watch_id(bytes(range(16)).hex()),
        viewer=1,
        encodes=("h264",),
    ),
    messages.State(
        revision=7,
        scene={"version": 2, "floor": {"kind": "mirror"}},
        falling=True,
        asleep=False,
        motions={"ruby": "falling", "glass": "asleep"},
        exactness=0.75,
        pinned=True,
    ),
    messages.Change(
        revision=9, since=7, parts={"floor": {"kind": "matte"}, "stones.ruby": None}, falling=False, exactness=0.25
    ),
    messages.Snapshot(snapshot={"step": 12, "simulation": None}),
    messages.Viewers(count=2),
    messages.Problem(
        code="unusable_scene", message="camera.fov_degrees: too large; got 300", field="camera.fov_degrees"
    ),
    messages.Engine(status="down"),
    messages.Leaving(seconds=599.5),
    messages.Pong(time=1234.5),
    messages.Picked(number=3, stone=None),
    messages.Outlined(stone="stone", step=42, points=(0.5, 0.25, -0.5, 0.25, 0, -0.75)),
    messages.Reached(number=4, step=43),
)

REFUSED_CONTROL = {
    "not JSON": "orbit",
    "not an object": "[1, 2]",
    "no type": '{"yaw": 1, "pitch": 0}',
    "unknown type": '{"type": "explode"}',
    "missing field": '{"type": "orbit", "yaw": 1}',
    "unknown field": '{"type": "toggle_fall", "now": true}',
    "wrong kind": '{"type": "visibility", "visible": "perhaps"}',
    "not a number": '{"type": "dolly", "forward": NaN}',
    "infinite": '{"type": "translate", "right": 1e999, "up": 0}',
    "out of range": '{"type": "resize", "width": 100000, "height": 720}',
    "zero": '{"type": "resize", "width": 0, "height": 720}',
    "too exact": '{"type": "balance", "exactness": 1.5, "pinned": false}',
    "unknown target": '{"type": "orbit", "target": "light_3", "yaw": 0, "pitch": 0}',
    "a stone's id in capitals": '{"type": "toggle_fall", "stone": "Ruby"}',
    "a pick without a number": '{"type": "pick", "x": 0, "y": 0}',
    "an unknown codec": '{"type": "decoders", "codecs": ["mpeg2"]}',
    "negative sequence": '{"type": "ack", "sequence": -1}',
}

REFUSED_NOTICES = {
    "not JSON": "hello",
    "not an object": "[]",
    "no type": '{"count": 1}',
    "missing field": '{"type": "viewers"}',
    "wrong kind": '{"type": "state", "revision": 1, "scene": [], "falling": true}',
    "unknown status": '{"type": "engine", "status": "sideways"}',
    "not an integer": '{"type": "viewers", "count": 1.5}',
}


def generated() -> dict[str, bytes]:
    """File name -> contents, of everything in `protocol/fixtures`."""
    listing = {name: {"file": f"{name}.bin", **finding} for name, (_, finding) in frames().items()}
    spoken = {
        "control_events": [event.model_dump(mode="json", exclude_none=True) for event in CONTROL_EVENTS],
        "notices": [notice.model_dump(mode="json") for notice in NOTICES],
        "refused_control_events": REFUSED_CONTROL,
        "refused_notices": REFUSED_NOTICES,
    }
    files = {f"{name}.bin": data for name, (data, _) in frames().items()}
    for name, content in {"frames.json": listing, "messages.json": spoken}.items():
        files[name] = (json.dumps(content, indent=2) + "\n").encode()
    return files


def main() -> None:
    """Write the files."""
    FIXTURES.mkdir(exist_ok=True)
    for name, data in generated().items():
        (FIXTURES / name).write_bytes(data)


if __name__ == "__main__":
    main()
