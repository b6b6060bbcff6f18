"""PNG pictures: every colour type and bit depth, their numbers made linear as the file's chunks say.

Which chunk counts if several speak of colour: cICP, iCCP, sRGB, then gAMA and cHRM (W3C, Portable Network Graphics,
third edition, 2025, section 4.3 and table 7).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.panoramas import Panorama
from culet.optics.sky_files.colour import (
    NAMES,
    REC_709,
    Matrix,
    Primaries,
    conversion_finding,
    converted,
    name_of,
    to_rec709,
)
from culet.optics.sky_files.decoder import MAGIC, decoding
from culet.optics.sky_files.picture import Allocate, Census, check_size

Rows = NDArray[np.float32]
Transfer = Callable[[Rows], Rows]
"""Encoded numbers, 0 to 1, to linear ones."""

MOST_PROFILE_BYTES = 2**22
"""Of a colour profile, uncompressed."""

CICP_PRIMARIES = {1: REC_709, 9: NAMES["Rec. 2020"], 12: NAMES["Display P3"]}
"""By their numbers in ITU-T H.273."""


def from_srgb(encoded: Rows) -> Rows:
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _unchanged(encoded: Rows) -> Rows:
    return encoded


def from_rec709(encoded: Rows) -> Rows:
    """ITU-R BT.709, the inverse of its camera's curve."""
    return np.where(encoded < 0.081, encoded / 4.5, ((encoded + 0.099) / 1.099) ** (1 / 0.45)).astype(np.float32)


CICP_TRANSFERS: dict[int, Transfer] = {
    1: from_rec709, 6: from_rec709, 14: from_rec709, 15: from_rec709, 8: _unchanged, 13: from_srgb,
}  # fmt: skip
"""By their numbers in ITU-T H.273, too."""


@dataclass(frozen=True)
class PngEncoding:
    """What the numbers mean."""

    transfer: Transfer
    matrix: Matrix | None
    """To Rec. 709's colours."""
    source: str
    """Name of the colours that the matrix converts."""
    findings: tuple[str, ...]


def read_png(data: bytes, max_pixels: int, allocate: Allocate, census: Census) -> Panorama:
    """(height, width, 3) linear radiance; InputError."""
    chunks = _chunks(data)
    width, height = _size(chunks)
    check_size(width, height, max_pixels)
    encoding = _encoding(chunks)
    census.findings += encoding.findings
    pixels = allocate((height, width, 3))
    transparent, outside = 0, 0
    with decoding(data, "png", **{"oiio:UnassociatedAlpha": 1}) as decoder:
        for first, rows in decoder.rows():
            grey = rows.shape[-1] < 3
            colours = encoding.transfer(np.repeat(rows[..., :1], 3, axis=-1) if grey else rows[..., :3])
            if encoding.matrix is not None:
                colours, moved = converted(colours, encoding.matrix)
                outside += moved
            if rows.shape[-1] in (2, 4):
                transparent += int((rows[..., -1] < 1).sum())
                colours = colours * rows[..., -1:]
            census.count(colours, first)
            pixels[first : first + len(rows)] = colours
    if encoding.matrix is not None:
        census.findings.append(conversion_finding(encoding.source, outside))
    if transparent:
        census.findings.append(f"{transparent} of {width * height} pixels are transparent; black is behind them.")
    return pixels


def _chunks(data: bytes) -> dict[bytes, bytes]:
    """The first of each kind before the pixels, all but those of the pixels themselves; InputError."""
    if not data.startswith(MAGIC["png"]):
        raise InputError(f"expected a .png picture, which begins with {MAGIC['png']!r}; got {data[:8]!r}", "file")
    found: dict[bytes, bytes] = {}
    position = len(MAGIC["png"])
    while position + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, position)
        content = data[position + 8 : position + 8 + length]
        if kind == b"IDAT":
            found[kind] = b""
            break
        if len(content) < length or position + 12 + length > len(data):
            break
        if zlib.crc32(kind + content) != int.from_bytes(data[position + 8 + length : position + 12 + length], "big"):
            raise InputError(
                f"the .png picture is damaged: the checksum of its chunk {kind.decode('latin-1')} is wrong", "file"
            )
        found.setdefault(kind, content)
        position += 12 + length
    if len(found.get(b"IHDR", b"")) != 13:
        raise InputError("the .png picture is damaged or cut off: it has no header", "file")
    if b"IDAT" not in found:
        raise InputError("the .png picture is damaged or cut off: it has no pixels", "file")
    return found


def _size(chunks: dict[bytes, bytes]) -> tuple[int, int]:
    width, height = struct.unpack_from(">II", chunks[b"IHDR"])
    return width, height


def _encoding(chunks: dict[bytes, bytes]) -> PngEncoding:
    findings = []
    if b"acTL" in chunks:
        findings.append("The picture is animated; its first frame was taken.")
    if b"cICP" in chunks:
        return _of_code_points(chunks[b"cICP"], findings)
    if b"iCCP" in chunks:
        findings += _profile_findings(chunks[b"iCCP"])
        return PngEncoding(from_srgb, None, "", tuple(findings))
    if b"sRGB" in chunks:
        return PngEncoding(from_srgb, None, "", tuple(findings))
    transfer: Transfer = from_srgb
    if b"gAMA" in chunks:
        transfer = _power(_whole(chunks[b"gAMA"], 1, "gAMA")[0])
    matrix, source = None, ""
    if b"cHRM" in chunks:
        numbers = [number / 100_000 for number in _whole(chunks[b"cHRM"], 8, "cHRM")]
        white, red, green, blue = [(numbers[i], numbers[i + 1]) for i in (0, 2, 4, 6)]
        primaries = Primaries(red, green, blue, white)
        matrix, source = to_rec709(primaries), name_of(primaries)
    return PngEncoding(transfer, matrix, source, tuple(findings))


def _power(gamma: int) -> Transfer:
    """Of gAMA, the exponent of the encoding in hundred thousandths."""
    if not 1000 <= gamma <= 10_000_000:
        raise InputError(f"expected a gAMA chunk of 1000 to 10000000 hundred thousandths, got {gamma}", "file")
    if gamma == 100_000:
        return _unchanged
    exponent = np.float32(100_000 / gamma)
    return lambda encoded: np.asarray(encoded**exponent, np.float32)


def _whole(content: bytes, count: int, name: str) -> tuple[int, ...]:
    if len(content) != 4 * count:
        raise InputError(
            f"the .png picture is damaged: expected {4 * count} bytes in {name}, got {len(content)}", "file"
        )
    return struct.unpack(f">{count}I", content)


def _of_code_points(content: bytes, findings: list[str]) -> PngEncoding:
    """ITU-T H.273's numbers of primaries and transfer, and whether all numbers are used."""
    primaries, transfer, matrix, full = content if len(content) == 4 else (0, 0, 0, 0)
    if primaries not in CICP_PRIMARIES or transfer not in CICP_TRANSFERS or matrix != 0 or full != 1:
        raise InputError(
            f"expected a cICP chunk of primaries {', '.join(map(str, CICP_PRIMARIES))}, transfer "
            f"{', '.join(map(str, sorted(CICP_TRANSFERS)))}, matrix 0 and full range 1; got {list(content[:8])}",
            "file",
        )
    colours = CICP_PRIMARIES[primaries]
    return PngEncoding(CICP_TRANSFERS[transfer], to_rec709(colours), name_of(colours), tuple(findings))


def _profile_findings(content: bytes) -> list[str]:
    """What to say of an ICC profile: nothing of one that says sRGB."""
    name, _, compressed = content.partition(b"\0")
    called = name.decode("latin-1")[:79] or "without a name"
    try:
        profile = zlib.decompressobj().decompress(compressed[1:], MOST_PROFILE_BYTES)
    except zlib.error:
        return [f"The colour profile {called!r} is damaged; numbers were taken for sRGB's."]
    described = called.encode("latin-1", "replace") + profile[:4096].replace(b"\0", b"")
    if b"srgb" in described.lower():
        return []
    return [f"The colour profile {called!r} was not applied; numbers were taken for sRGB's."]
