"""Pictures byte by byte, as their formats' specifications have them, so that a test can write what no library would."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

PNG_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
"""By colour type."""


def chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png(samples: NDArray[np.integer[Any]], colour_type: int, depth: int, *chunks: tuple[bytes, bytes]) -> bytes:
    """Samples (height, width, channels) of that depth, every row unfiltered."""
    height, width, _ = samples.shape
    rows = []
    for row in samples:
        numbers = row.reshape(-1)
        if depth == 16:
            packed = numbers.astype(">u2").tobytes()
        elif depth == 8:
            packed = numbers.astype(np.uint8).tobytes()
        else:
            bits = "".join(f"{number:0{depth}b}" for number in numbers)
            bits += "0" * (-len(bits) % 8)
            packed = bytes(int(bits[i : i + 8], 2) for i in range(0, len(bits), 8))
        rows.append(b"\0" + packed)
    head = struct.pack(">IIBBBBB", width, height, depth, colour_type, 0, 0, 0)
    middle = b"".join(chunk(*each) for each in chunks)
    pixels = chunk(b"IDAT", zlib.compress(b"".join(rows)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + middle + pixels + chunk(b"IEND", b"")


def attribute(name: str, kind: str, value: bytes) -> bytes:
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def floats(*numbers: float) -> bytes:
    return struct.pack(f"<{len(numbers)}f", *numbers)


def text(name: str, value: str) -> bytes:
    return attribute(name, "string", value.encode())


Box = tuple[int, int, int, int]
"""First column, first row, last column, last row."""


def exr(
    channels: Mapping[str, NDArray[np.generic]],
    *attributes: bytes,
    sampling: Mapping[str, int] | None = None,
    display: Box | None = None,
    first: tuple[int, int] = (0, 0),
    decreasing: bool = False,
    pixel_aspect: float = 1,
) -> bytes:
    """One part of scanlines without compression (OpenEXR File Layout); `first` is the data window's corner."""
    sampling = sampling or {}
    types = {"uint32": (0, "<u4"), "float16": (1, "<f2"), "float32": (2, "<f4")}
    names = sorted(channels)
    steps = {name: sampling.get(name, 1) for name in names}
    full = next(channels[name] for name in names if steps[name] == 1)
    height, width = full.shape
    x, y = first
    data = (x, y, x + width - 1, y + height - 1)
    listed = b"".join(
        name.encode()
        + b"\0"
        + struct.pack("<iBxxxii", types[channels[name].dtype.name][0], 1, steps[name], steps[name])
        for name in names
    )
    head = b"".join(
        [
            b"\x76\x2f\x31\x01", struct.pack("<I", 2), attribute("channels", "chlist", listed + b"\0"),
            attribute("compression", "compression", b"\0"), attribute("dataWindow", "box2i", struct.pack("<4i", *data)),
            attribute("displayWindow", "box2i", struct.pack("<4i", *(display or data))),
            attribute("lineOrder", "lineOrder", bytes([decreasing])),
            attribute("pixelAspectRatio", "float", floats(pixel_aspect)),
            attribute("screenWindowCenter", "v2f", floats(0, 0)), attribute("screenWindowWidth", "float", floats(1)),
            *attributes, b"\0",
        ]
    )  # fmt: skip
    lines = []
    for row in range(height):
        pixels = b"".join(
            channels[name][row // steps[name]].astype(types[channels[name].dtype.name][1]).tobytes()
            for name in names
            if row % steps[name] == 0
        )
        lines.append(struct.pack("<ii", y + row, len(pixels)) + pixels)
    places = dict.fromkeys(range(height), 0)
    body, begin = b"", len(head) + 8 * height
    for row in reversed(range(height)) if decreasing else range(height):
        places[row] = begin + len(body)
        body += lines[row]
    return head + struct.pack(f"<{height}Q", *places.values()) + body


def grey(height: int = 4, value: float = 0.5) -> dict[str, NDArray[np.generic]]:
    """Red, green and blue channels of one value."""
    return {name: np.full((height, 2 * height), value, np.float32) for name in "RGB"}


def hdr(rgbe: NDArray[np.uint8], *lines: str, size: str | None = None, form: str | None = "32-bit_rle_rgbe") -> bytes:
    """Pixels (height, width, 4), not run-length encoded."""
    height, width, _ = rgbe.shape
    head = ["#?RADIANCE", *([] if form is None else [f"FORMAT={form}"]), *lines, "", size or f"-Y {height} +X {width}"]
    return "".join(f"{line}\n" for line in head).encode() + rgbe.astype(np.uint8).tobytes()


def run_lengths(rgbe: NDArray[np.uint8]) -> bytes:
    """The same pixels with each component of each row as runs of equal bytes and others."""
    out = b""
    for row in rgbe:
        out += bytes([2, 2, len(row) >> 8, len(row) & 255])
        for component in row.T:
            out += b"".join(_runs(component.tolist()))
    return out


def _runs(values: Sequence[int]) -> list[bytes]:
    found, at = [], 0
    while at < len(values):
        end = at
        while end < len(values) and values[end] == values[at] and end - at < 127:
            end += 1
        found.append(bytes([128 + end - at, values[at]]) if end - at > 1 else bytes([1, values[at]]))
        at = end
    return found
