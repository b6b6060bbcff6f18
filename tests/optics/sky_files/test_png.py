"""Every colour type and bit depth of PNG, against IEC 61966-2-1 and what the file's chunks say."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.sky_files.reading import read_sky
from optics.sky_files.writers import PNG_CHANNELS, chunk, png

Array = NDArray[Any]


def linear(encoded: Array) -> Array:
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def samples(colour_type: int, depth: int) -> Array:
    shape = (8, 16, PNG_CHANNELS[colour_type])
    return np.random.default_rng(depth).integers(0, 1 << depth, shape)


def colours(values: Array, colour_type: int, depth: int) -> Array:
    """As the specification reads them: (8, 16, 3), over black where they are transparent."""
    part = values / ((1 << depth) - 1)
    red_green_blue = linear(np.repeat(part[..., :1], 3, axis=-1) if colour_type in (0, 4) else part[..., :3])
    return red_green_blue * part[..., -1:] if colour_type in (4, 6) else red_green_blue


@pytest.mark.parametrize(
    ("colour_type", "depth"),
    [(0, 1), (0, 2), (0, 4), (0, 8), (0, 16), (2, 8), (2, 16), (4, 8), (4, 16), (6, 8), (6, 16)],
)
def test_every_colour_type_and_depth_is_read_in_full(colour_type: int, depth: int) -> None:
    values = samples(colour_type, depth)
    sky = read_sky(png(values, colour_type, depth), "png")
    assert sky.pixels == pytest.approx(colours(values, colour_type, depth), abs=2e-6)  # measured 2e-7
    transparent = colour_type in (4, 6)
    assert bool(sky.findings) == transparent
    if transparent:
        count = int((values[..., -1] < (1 << depth) - 1).sum())
        assert sky.findings == (f"{count} of 128 pixels are transparent; black is behind them.",)


@pytest.mark.parametrize("depth", [1, 2, 4, 8])
def test_a_palette_gives_its_colours_and_its_transparency(depth: int) -> None:
    values = samples(3, depth)
    palette = np.random.default_rng(1).integers(0, 256, (1 << depth, 3))
    opacity = np.full(1 << depth, 255)
    opacity[0] = 51
    chunks = (b"PLTE", palette.astype(np.uint8).tobytes()), (b"tRNS", opacity[:1].astype(np.uint8).tobytes())
    expected = linear(palette / 255) * (opacity / 255)[:, None]
    sky = read_sky(png(values, 3, depth, *chunks), "png")
    assert sky.pixels == pytest.approx(expected[values[..., 0]], abs=2e-6)


@pytest.mark.parametrize(("colour_type", "key"), [(0, [3]), (2, [3, 3, 3])])
def test_the_colour_that_is_transparent_lets_black_through(colour_type: int, key: list[int]) -> None:
    values = np.full((2, 4, PNG_CHANNELS[colour_type]), 200)
    values[0, 0] = 3
    sky = read_sky(png(values, colour_type, 8, (b"tRNS", struct.pack(f">{len(key)}H", *key))), "png")
    assert (sky.pixels[0, 0] == 0).all()
    assert sky.pixels[1, 1] == pytest.approx(np.full(3, linear(np.array(200 / 255))), abs=1e-6)


def test_gamma_is_applied_as_the_file_has_it() -> None:
    values = samples(2, 8)
    for gamma in (100_000, 45_455, 55_000):
        sky = read_sky(png(values, 2, 8, (b"gAMA", struct.pack(">I", gamma))), "png")
        assert sky.pixels == pytest.approx((values / 255) ** (100_000 / gamma), abs=2e-6)


def test_what_says_srgb_is_srgb_whatever_its_gamma_says() -> None:
    values = samples(2, 8)
    both = (b"sRGB", b"\0"), (b"gAMA", struct.pack(">I", 100_000))
    assert read_sky(png(values, 2, 8, *both), "png").pixels == pytest.approx(linear(values / 255), abs=2e-6)


REC_709 = (31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000)
"""White, red, green, blue, as a chunk cHRM has them."""


def test_other_primaries_are_converted_and_said() -> None:
    """Display P3's red is beyond Rec. 709: SMPTE RP 431-2's primaries by RP 177's matrices give 1.2249, -0.0421,
    -0.0196 there, and white stays white."""
    values = np.full((2, 4, 3), 255)
    values[0, 0] = 255, 0, 0
    p3 = (31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000)
    linear_p3 = (b"gAMA", struct.pack(">I", 100_000)), (b"cHRM", struct.pack(">8I", *p3))
    sky = read_sky(png(values, 2, 8, *linear_p3), "png")
    assert sky.pixels[1, 1] == pytest.approx([1, 1, 1], abs=1e-4)
    red, green, blue = (float(c) for c in sky.pixels[0, 0])
    assert (green >= 0, blue >= 0) == (True, True)
    weights = 0.212639, 0.715169, 0.072192
    assert weights[0] * red + weights[1] * green + weights[2] * blue == pytest.approx(
        weights[0] * 1.2249 - weights[1] * 0.0421 - weights[2] * 0.0196, abs=1e-4
    )
    (finding,) = sky.findings
    assert "Display P3" in finding
    assert "1 pixels had colours beyond it" in finding
    same = read_sky(png(values, 2, 8, (b"cHRM", struct.pack(">8I", *REC_709))), "png")
    assert same.findings == ()


def test_code_points_are_honoured_or_refused_by_their_numbers() -> None:
    values = samples(2, 8)
    sky = read_sky(png(values, 2, 8, (b"cICP", bytes([1, 8, 0, 1]))), "png")
    assert sky.pixels == pytest.approx(values / 255, abs=1e-6)
    with pytest.raises(InputError, match=r"cICP chunk of primaries .*; got \[9, 16, 0, 1\]"):
        read_sky(png(values, 2, 8, (b"cICP", bytes([9, 16, 0, 1]))), "png")


def test_a_colour_profile_is_named_unless_it_is_srgbs() -> None:
    values = samples(2, 8)
    for name, told in ((b"Adobe RGB (1998)", True), (b"sRGB IEC61966-2.1", False)):
        profile = name + b"\0\0" + zlib.compress(b"profile")
        findings = read_sky(png(values, 2, 8, (b"iCCP", profile)), "png").findings
        assert bool(findings) == told
        assert all(name.decode() in finding for finding in findings)


def test_of_an_animation_the_first_frame_is_taken_and_said() -> None:
    sky = read_sky(png(samples(0, 8), 0, 8, (b"acTL", struct.pack(">II", 2, 0))), "png")
    assert sky.findings == ("The picture is animated; its first frame was taken.",)


def test_a_wrong_checksum_is_named_by_its_chunk() -> None:
    good = png(samples(0, 8), 0, 8, (b"gAMA", struct.pack(">I", 100_000)))
    at = good.index(b"gAMA") + 4
    with pytest.raises(InputError, match="the checksum of its chunk gAMA is wrong"):
        read_sky(good[:at] + b"\1" + good[at + 1 :], "png")


def test_an_interlaced_picture_is_the_same_picture() -> None:
    """Adam7 of one pass: a picture of 1 x 1 blocks has only the first."""
    values = samples(2, 8)
    head = struct.pack(">IIBBBBB", 16, 8, 8, 2, 0, 0, 1)
    passes = [(0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)]
    rows = b"".join(
        b"\0" + row.astype(np.uint8).tobytes()
        for top, left, down, across in passes
        for row in values[top::down, left::across]
    )
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    assert read_sky(data, "png").pixels == pytest.approx(linear(values / 255), abs=2e-6)
