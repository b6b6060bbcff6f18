"""Radiance pictures (.hdr): what their header says, and their pixels, which OpenImageIO decodes.

The format is Radiance's (G. Ward, Real Pixels, Graphics Gems II, 1991; Radiance's File Formats, 1999): lines of text to
an empty one, a line of the size with the order of the pixels, then four bytes for each, plain or run-length encoded.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.panoramas import Panorama
from culet.optics.sky_files.colour import (
    RADIANCE,
    REC_709,
    Chromaticity,
    Matrix,
    Primaries,
    conversion_finding,
    converted,
    name_of,
    to_rec709,
    to_xyz,
)
from culet.optics.sky_files.decoder import decoding
from culet.optics.sky_files.picture import Allocate, Census, check_size

MOST_HEADER_BYTES = 2**16
RGBE, XYZE = "32-bit_rle_rgbe", "32-bit_rle_xyze"
_SIZE = re.compile(r"([+-])([XY]) +(\d{1,9}) +([+-])([XY]) +(\d{1,9})\s*")


@dataclass
class HdrHeader:
    """What the lines before the pixels say."""

    format: str | None = None
    exposure: float = 1.0
    """Product of all EXPOSURE lines."""
    correction: NDArray[np.float64] = field(default_factory=lambda: np.ones(3))
    """Product of all COLORCORR lines."""
    primaries: Primaries | None = None
    pixel_aspect: float = 1.0
    gamma: float = 1.0
    view: str = ""


@dataclass(frozen=True)
class PixelOrder:
    """In which order the pixels come."""

    slow_axis: str
    """Of the scanlines: Y for rows, X for columns."""
    slow: int
    fast: int
    """How many along each axis."""
    top_first: bool
    left_first: bool

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return (self.fast, self.slow) if self.slow_axis == "Y" else (self.slow, self.fast)

    def upright(self, pixels: Panorama) -> Panorama:
        """A view of the panorama whose rows are the file's scanlines."""
        turned = pixels if self.top_first else pixels[::-1]
        turned = turned if self.left_first else turned[:, ::-1]
        return turned if self.slow_axis == "Y" else turned.transpose(1, 0, 2)


def read_radiance(data: bytes, max_pixels: int, allocate: Allocate, census: Census) -> Panorama:
    """(height, width, 3) linear radiance; InputError."""
    lines, begin = _head(data)
    header = _header(lines[:-1])
    order = _order(lines[-1])
    width, height = order.size
    check_size(width, height, max_pixels)
    matrix = _matrix(header, census)
    census.findings += _findings(header)
    body = _with_old_runs_expanded(data[begin:], order)
    plain = f"#?RADIANCE\nFORMAT={RGBE}\n\n-Y {order.slow} +X {order.fast}\n".encode()
    pixels = allocate((height, width, 3))
    target = order.upright(pixels)
    outside = 0
    with decoding(plain + body, "hdr") as decoder:
        for first, rows in decoder.rows():
            colours = rows + _half_a_step(rows)
            if matrix is not None:
                colours, moved = converted(colours, matrix)
                outside += moved
            census.count(colours, first)
            target[first : first + len(rows)] = colours
    if matrix is not None:
        census.findings.append(conversion_finding(_source(header), outside))
    return pixels


def _half_a_step(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """A byte b stands for what was truncated to it, b to b + 1, so that b + 1/2 is right on average, as Radiance has
    it; the library gives b. Bytes are of the exponent of the pixel's largest, which is from 128 to 255 of 256."""
    largest = rows.max(axis=-1, keepdims=True)
    exponent = np.frexp(largest)[1]
    return np.where(largest > 0, np.ldexp(np.float32(1), exponent - 9), 0).astype(np.float32)


def _head(data: bytes) -> tuple[list[str], int]:
    """The header's lines, the line of the size last, and where the pixels begin."""
    if not data.startswith(b"#?"):
        raise InputError(f"expected a Radiance picture, which begins with b'#?'; got {data[:8]!r}", "file")
    text = data[:MOST_HEADER_BYTES]
    empty = re.search(rb"\n\r?\n", text)
    if empty is None:
        raise InputError("expected a Radiance header that ends with an empty line, got none", "file")
    end = text.find(b"\n", empty.end())
    if end < 0:
        raise InputError("expected a line of the picture's size after the Radiance header, got the end of it", "file")
    lines = [*text[: empty.start()].split(b"\n")[1:], text[empty.end() : end]]
    return [line.decode("latin-1").strip() for line in lines], end + 1


def _header(lines: list[str]) -> HdrHeader:
    header = HdrHeader()
    for line in lines:
        name, found, value = line.partition("=")
        if not found or name.startswith("#"):
            continue
        match name.strip().upper():
            case "FORMAT":
                header.format = value.strip()
            case "EXPOSURE":
                header.exposure *= _numbers(line, value, 1)[0]
            case "COLORCORR":
                header.correction = header.correction * _numbers(line, value, 3)
            case "PRIMARIES":
                numbers = _numbers(line, value, 8)
                header.primaries = Primaries(*[(numbers[i], numbers[i + 1]) for i in (0, 2, 4, 6)])
            case "PIXASPECT":
                header.pixel_aspect *= _numbers(line, value, 1)[0]
            case "GAMMA":
                header.gamma = _numbers(line, value, 1)[0]
            case "VIEW":
                header.view = value.strip()
    if header.format not in (None, RGBE, XYZE):
        raise InputError(f"expected a Radiance picture of FORMAT={RGBE} or {XYZE}, got {header.format[:60]!r}", "file")
    return header


def _numbers(line: str, value: str, count: int) -> list[float]:
    words = value.split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count or not np.isfinite(numbers).all() or (count < 8 and min(numbers) <= 0):
        wanted = "a number above 0" if count == 1 else f"{count} numbers"
        raise InputError(f"expected {wanted} in the Radiance header's line, got {line[:80]!r}", "file")
    return numbers


def _order(line: str) -> PixelOrder:
    found = _SIZE.fullmatch(line)
    if found is None or found[2] == found[5]:
        raise InputError(f"expected the picture's size such as '-Y 512 +X 1024', got {line[:60]!r}", "file")
    sign = {found[2]: found[1], found[5]: found[4]}
    return PixelOrder(found[2], int(found[3]), int(found[6]), top_first=sign["Y"] == "-", left_first=sign["X"] == "+")


def _matrix(header: HdrHeader, census: Census) -> Matrix | None:
    """To Rec. 709. Red, green and blue without primaries are taken for it, as by every program that reads skies."""
    if header.format == XYZE:  # Radiance's white has X = Y = Z, and a grey is to stay a grey
        return np.asarray(np.linalg.inv(to_xyz(RADIANCE)))
    if header.primaries is None or header.primaries.same(RADIANCE):
        return None
    if header.primaries.same(Primaries(*REC_709[:3], white=_EQUAL)):
        census.findings.append(
            "PRIMARIES names those of Rec. 709 with another white; the numbers were left as they are."
        )
        return None
    return to_rec709(header.primaries)


_EQUAL: Chromaticity = (1 / 3, 1 / 3)


def _source(header: HdrHeader) -> str:
    if header.format == XYZE:
        return "CIE XYZ"
    return name_of(header.primaries or REC_709)


def _findings(header: HdrHeader) -> list[str]:
    found = []
    if header.format is None:
        found.append(f"The header names no FORMAT; {RGBE} was assumed.")
    if header.exposure != 1:
        found.append(
            f"EXPOSURE says that the picture's radiance was multiplied by {header.exposure:.4g}; this was not undone "
            f"(an environment.scale of {1 / header.exposure:.4g} would)."
        )
    if (header.correction != 1).any():
        red, green, blue = header.correction
        found.append(
            f"COLORCORR says that red, green and blue were multiplied by {red:.4g}, {green:.4g} and {blue:.4g}; this "
            "was not undone."
        )
    if header.gamma != 1:
        found.append(f"GAMMA={header.gamma:g} was not applied: pixels are linear in this format.")
    if header.pixel_aspect != 1:
        found.append(f"PIXASPECT={header.pixel_aspect:g} was not used: a sky covers all directions in any case.")
    if header.view:
        found.append(f"VIEW={header.view[:60]} says that a camera saw the picture; it was taken for all directions.")
    return found


def _with_old_runs_expanded(body: bytes, order: PixelOrder) -> bytes:
    """Pixels, their run-length encoding from before 1991 undone, where a pixel of bytes 1, 1, 1, n repeats the one
    before it n times, and one right after it 256 n times; other pictures as they are."""
    if 8 <= order.fast <= 0x7FFF and body[:2] == b"\2\2":
        return body
    pixels = np.frombuffer(body, np.uint8, len(body) // 4 * 4).reshape(-1, 4)
    run = (pixels[:, :3] == 1).all(axis=1)
    wanted = order.slow * order.fast
    if not run.any():
        if len(pixels) < wanted:
            raise InputError(
                f"the .hdr picture is damaged or cut off: expected {4 * wanted} bytes of pixels, got {len(body)}",
                "file",
            )
        return body
    if run[0]:
        raise InputError("the .hdr picture is damaged: it begins with a run that repeats nothing", "file")
    places = np.flatnonzero(run)
    in_a_row = np.zeros(len(places), np.int64)
    for i in range(1, len(places)):
        in_a_row[i] = in_a_row[i - 1] + 1 if places[i] == places[i - 1] + 1 else 0
    counts = np.ones(len(pixels), np.int64)
    counts[places] = pixels[places, 3].astype(np.int64) << np.minimum(8 * in_a_row, 32)
    if int(counts.sum()) < wanted:
        raise InputError(
            f"the .hdr picture is damaged or cut off: expected {wanted} pixels, got {int(counts.sum())}", "file"
        )
    last = int(np.searchsorted(np.cumsum(counts), wanted)) + 1
    repeated = np.maximum.accumulate(np.where(run, 0, np.arange(len(pixels))))[:last]
    counts = counts[:last]
    counts[-1] -= int(counts.sum()) - wanted
    return np.repeat(pixels[repeated], counts, axis=0).tobytes()
