"""Files that mean harm: large ones in small ones, and good ones with bytes changed."""

from __future__ import annotations

import io
import random
import struct
import zlib
from collections.abc import Iterator
from itertools import cycle

import numpy as np
import trimesh
from PIL import Image

from culet.geometry.designs.asc_writer import asc_of
from geometry.designs.files import design, gcs_of, gem_of

MESHES = ("obj", "off", "stl", "ply", "glb")
DESIGNS = ("asc", "gem", "gcs")
SKIES = ("png", "hdr")


def png_bomb(width: int, height: int) -> bytes:
    """A picture of one grey, packed as small as can be."""
    packer = zlib.compressobj(9)
    row = b"\0" + bytes([100]) * width
    packed = b"".join(packer.compress(row) for _ in range(height)) + packer.flush()
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        _chunk(name, data) for name, data in ((b"IHDR", header), (b"IDAT", packed), (b"IEND", b""))
    )


def hdr_bomb(width: int, height: int, value: int = 100) -> bytes:
    """The same in Radiance's run lengths."""
    line = bytes([2, 2, width >> 8, width & 255])
    for channel in range(4):
        left = width
        while left:
            run = min(127, left)
            line += bytes([128 + run, value if channel < 3 else 129])
            left -= run
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + line * height


def seeds() -> dict[str, bytes]:
    """A good file of each kind, by its ending."""
    solid = trimesh.creation.icosphere(subdivisions=1)
    files = {ending: solid.export(file_type=ending) for ending in MESHES}
    picture = io.BytesIO()
    Image.fromarray(np.random.default_rng(1).integers(0, 255, (8, 16, 3), np.uint8)).save(picture, "PNG")
    made = {ending: data.encode() if isinstance(data, str) else bytes(data) for ending, data in files.items()}
    single = design("03_single_cut")
    made |= {"asc": asc_of(single)[1], "gem": gem_of(single), "gcs": gcs_of(single)}
    return made | {"png": picture.getvalue(), "hdr": hdr_bomb(16, 8)}


def mutated(count: int, seed: int) -> Iterator[tuple[str, bytes]]:
    """So many files, each with its ending: bytes changed, doubled, cut out or cut off."""
    dice = random.Random(seed)  # noqa: S311 - which bytes
    good = seeds()
    for _, ending in zip(range(count), cycle([*MESHES, *DESIGNS, *SKIES]), strict=False):
        data = bytearray(good[ending])
        for _ in range(dice.choice((1, 1, 2, 5, 20))):
            at = dice.randrange(len(data))
            match dice.randrange(5):
                case 0:
                    data[at] = dice.randrange(256)
                case 1:
                    data[at : at + 4] = struct.pack("<I", dice.choice((0, 1, 2**31 - 1, 2**31, 2**32 - 1)))
                case 2:
                    data[at:at] = data[at : at + dice.randrange(1, 64)]
                case 3:
                    del data[at : at + dice.randrange(1, 64)]
                case _:
                    data[at:at] = dice.choice((b"nan ", b"1e999 ", b"-1 ", b"\0", b"\xff\xfe", b"9" * 400))
            data = data or bytearray(b"x")
        yield ending, bytes(data)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
