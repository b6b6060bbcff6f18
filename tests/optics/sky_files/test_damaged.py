"""Files that end too early, or have other bytes than they had: refused as such, or read, and nothing else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from culet.errors import InputError
from culet.optics.sky_files.reading import read_sky
from optics.sky_files.writers import hdr, png, run_lengths

COLOURS = np.random.default_rng(5).random((32, 64, 3)).astype(np.float32)
RGBE = np.concatenate([(128 + 127 * COLOURS), np.full((32, 64, 1), 128)], axis=-1).astype(np.uint8)


def compressed(name: str, tmp_path: Path) -> bytes:
    path = tmp_path / "whole.exr"
    OpenEXR.File({"compression": getattr(OpenEXR, f"{name}_COMPRESSION")}, {"RGB": COLOURS}).write(str(path))
    return path.read_bytes()


WHOLE: dict[str, tuple[str, Callable[[Path], bytes]]] = {
    "png": ("png", lambda _: png((255 * COLOURS).astype(np.uint8), 2, 8)),
    "png of 16 bits": ("png", lambda _: png((65535 * COLOURS).astype(np.uint16), 2, 16)),
    "hdr": ("hdr", lambda _: hdr(RGBE[:0], size="-Y 32 +X 64") + run_lengths(RGBE)),
    "plain hdr": ("hdr", lambda _: hdr(RGBE)),
    **{
        f"exr {name}": ("exr", lambda folder, name=name: compressed(name, folder))  # type: ignore[misc]
        for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "DWAA")
    },
}


@pytest.mark.parametrize("kind", WHOLE)
@pytest.mark.parametrize("part", [0, 0.02, 0.5, 0.9, 0.99])
def test_a_file_that_was_cut_off_is_refused_as_that(kind: str, part: float, tmp_path: Path) -> None:
    file_type, make = WHOLE[kind]
    data = make(tmp_path)
    assert read_sky(data, file_type).pixels.shape == (32, 64, 3)
    with pytest.raises(InputError, match=r"cut off|ends with an empty line|begins with|picture's size") as refusal:
        read_sky(data[: int(part * len(data))], file_type)
    assert refusal.value.field == "file"
    assert "/proc" not in str(refusal.value)


@pytest.mark.parametrize("kind", WHOLE)
def test_a_damaged_file_is_refused_or_read_and_nothing_else(kind: str, tmp_path: Path) -> None:
    file_type, make = WHOLE[kind]
    data, rng = make(tmp_path), np.random.default_rng(7)
    for _ in range(10):
        damaged = np.frombuffer(data, np.uint8).copy()
        near_its_head = rng.integers(0, min(400, len(data)), 2)
        damaged[[*near_its_head, *rng.integers(0, len(data), 2)]] ^= rng.integers(1, 256, 4).astype(np.uint8)
        try:
            pixels = read_sky(damaged.tobytes(), file_type, max_pixels=2**20).pixels
        except InputError:
            continue
        assert np.isfinite(pixels).all()
        assert pixels.min() >= 0


def test_a_file_of_another_kind_is_told_by_its_first_bytes() -> None:
    for file_type in ("png", "exr", "hdr"):
        with pytest.raises(InputError, match=r"which begins with .*; got b'\\xff\\xd8\\xff\\xe0"):
            read_sky(b"\xff\xd8\xff\xe0\x00\x10JFIF\x00", file_type)
    with pytest.raises(InputError, match=r"expected a sky as \.exr, \.hdr or \.png, got 'gif'"):
        read_sky(b"GIF89a", "gif")
