"""Radiance pictures, against Radiance's own rules: (byte + 1/2) 2^(exponent - 136)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.sky_files.reading import read_sky
from optics.sky_files.writers import hdr, run_lengths

Array = NDArray[Any]


def pixels(height: int = 4, width: int = 8) -> NDArray[np.uint8]:
    """Of which the largest component is from 128 to 255, as every writer has it."""
    rng = np.random.default_rng(3)
    rgbe = rng.integers(0, 256, (height, width, 4))
    rgbe[..., 0] = rng.integers(128, 256, (height, width))
    rgbe[..., 3] = rng.integers(120, 136, (height, width))
    return rgbe.astype(np.uint8)


def radiance(rgbe: NDArray[np.uint8]) -> Array:
    return (rgbe[..., :3] + 0.5) * 2.0 ** (rgbe[..., 3:].astype(int) - 136)


@pytest.mark.parametrize("encoded", [False, True])
def test_bytes_and_exponent_make_the_radiance(encoded: bool) -> None:
    rgbe = pixels()
    rgbe[0, 0] = 0
    expected = radiance(rgbe)
    expected[0, 0] = 0
    data = hdr(rgbe)
    if encoded:
        data = hdr(rgbe[:0], size="-Y 4 +X 8") + run_lengths(rgbe)
    sky = read_sky(data, "hdr")
    assert sky.pixels == pytest.approx(expected, rel=1e-6)
    assert sky.findings == ()


ORDERS = {
    "-Y 4 +X 8": lambda p: p,
    "+Y 4 +X 8": lambda p: p[::-1],
    "-Y 4 -X 8": lambda p: p[:, ::-1],
    "+Y 4 -X 8": lambda p: p[::-1, ::-1],
    "+X 8 -Y 4": lambda p: p.transpose(1, 0, 2),
    "-X 8 -Y 4": lambda p: p[:, ::-1].transpose(1, 0, 2),
    "+X 8 +Y 4": lambda p: p[::-1].transpose(1, 0, 2),
    "-X 8 +Y 4": lambda p: p[::-1, ::-1].transpose(1, 0, 2),
}
"""The line of the size, and an upright picture as such a file has its scanlines."""


@pytest.mark.parametrize("size", ORDERS)
def test_pixels_come_in_any_of_the_eight_orders(size: str) -> None:
    rgbe = pixels()
    stored = np.ascontiguousarray(ORDERS[size](rgbe))
    assert read_sky(hdr(stored, size=size), "hdr").pixels == pytest.approx(radiance(rgbe), rel=1e-6)


def test_runs_of_the_oldest_kind_repeat_the_pixel_before() -> None:
    """A pixel of bytes 1, 1, 1, n stands for n of the one before it, a second one in a row for 256 n."""
    rgbe = np.array([[[200, 3, 4, 128], [1, 1, 1, 44], [1, 1, 1, 1], [130, 5, 6, 127]]], np.uint8)
    sky = read_sky(hdr(rgbe, size="-Y 1 +X 302"), "hdr")
    assert sky.pixels[0, :301] == pytest.approx(np.tile(radiance(rgbe)[0, 0], (301, 1)), rel=1e-6)
    assert sky.pixels[0, 301] == pytest.approx(radiance(rgbe)[0, 3], rel=1e-6)


def test_a_grey_in_xyz_stays_that_grey() -> None:
    """Radiance's white has X = Y = Z; its primaries' luminances are 0.265, 0.670 and 0.065 (Radiance, color.h)."""
    grey = np.full((2, 4, 4), 128, np.uint8)
    sky = read_sky(hdr(grey, form="32-bit_rle_xyze"), "hdr")
    assert sky.pixels == pytest.approx(np.broadcast_to(radiance(grey), sky.pixels.shape), rel=2e-3)
    assert sky.findings == ("Colours were converted from CIE XYZ to Rec. 709.",)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("EXPOSURE=2", "an environment.scale of 0.5 would"),
        ("EXPOSURE=4\nEXPOSURE=0.5", "multiplied by 2;"),
        ("COLORCORR=1 2 3", "multiplied by 1, 2 and 3"),
        ("GAMMA=2.2", "GAMMA=2.2 was not applied"),
        ("PIXASPECT=2", "PIXASPECT=2 was not used"),
        ("VIEW= -vtv -vp 0 0 0", "VIEW=-vtv -vp 0 0 0"),
        ("PRIMARIES=0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290", "converted from Rec. 2020"),
    ],
)
def test_what_the_header_says_of_the_numbers_is_told(line: str, told: str) -> None:
    (finding,) = read_sky(hdr(pixels(), line), "hdr").findings
    assert told in finding


@pytest.mark.parametrize("line", ["EXPOSURE=1", "# a comment = 3", "SOFTWARE=any", "pfilt -1 -e 2"])
def test_what_changes_nothing_is_not_told(line: str) -> None:
    assert read_sky(hdr(pixels(), line), "hdr").findings == ()


def test_lines_may_end_as_in_dos_and_the_format_may_be_missing() -> None:
    data = hdr(pixels())
    head, body = data[: -4 * 4 * 8], data[-4 * 4 * 8 :]
    assert read_sky(head.replace(b"\n", b"\r\n") + body, "hdr").pixels == pytest.approx(radiance(pixels()), rel=1e-6)
    (finding,) = read_sky(hdr(pixels(), form=None), "hdr").findings
    assert "names no FORMAT" in finding


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (b"RADIANCE\n\n-Y 1 +X 2\n" + bytes(8), r"begins with b'#\?'"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", "ends with an empty line"),
        (hdr(pixels(), form="32-bit_rle_luv"), "FORMAT=32-bit_rle_rgbe or 32-bit_rle_xyze, got '32-bit_rle_luv'"),
        (hdr(pixels(), size="-Y 4 +Y 8"), "size such as '-Y 512 [+]X 1024', got '-Y 4 [+]Y 8'"),
        (hdr(pixels(), size="4 8"), "got '4 8'"),
        (hdr(pixels(), "EXPOSURE=bright"), "got 'EXPOSURE=bright'"),
        (hdr(pixels(), "EXPOSURE=0"), "a number above 0"),
        (hdr(pixels(), "PRIMARIES=1 2 3"), "8 numbers"),
        (hdr(pixels(), "PRIMARIES=0 0 0 0 0 0 0 0"), "primaries that span colours"),
        (b"#?RADIANCE\n\n-Y 4 +X 8", "line of the picture's size"),
        (hdr(pixels())[:-1], "cut off: expected 128 bytes of pixels, got 127"),
        (hdr(pixels()[:0], size="-Y 4 +X 8") + run_lengths(pixels())[:-3], "damaged or cut off"),
    ],
)  # fmt: skip
def test_a_refusal_names_the_true_cause(data: bytes, cause: str) -> None:
    with pytest.raises(InputError, match=cause) as refusal:
        read_sky(data, "hdr")
    assert refusal.value.field == "file"
