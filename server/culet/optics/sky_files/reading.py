"""The one way in: a file's bytes and its ending to a sky."""

from __future__ import annotations

import numpy as np

from culet.errors import InputError
from culet.optics.sky_files.exr import read_exr
from culet.optics.sky_files.picture import (
    MOST_PIXELS,
    Allocate,
    Census,
    SkyPicture,
    new_panorama,
    shape_findings,
)
from culet.optics.sky_files.png import read_png
from culet.optics.sky_files.radiance import read_radiance

READERS = {"exr": read_exr, "hdr": read_radiance, "png": read_png}


def read_sky(
    data: bytes, file_type: str, *, max_pixels: int = MOST_PIXELS, allocate: Allocate = new_panorama
) -> SkyPicture:
    """From an equirectangular .exr or .hdr (linear) or .png (sRGB, unless its header says otherwise) file.

    `allocate` makes the array that is kept; beside it reading takes a few rows, of an interlaced PNG once the file's
    pixels. InputError says what is wrong with the file; TooLargeError if it has more than `max_pixels`.
    """
    if file_type not in READERS:
        raise InputError(f"expected a sky as .exr, .hdr or .png, got {file_type!r}", "file")
    census = Census()
    with np.errstate(all="ignore"):  # what is not finite is counted
        pixels = READERS[file_type](data, max_pixels, allocate, census)
    census.settle(pixels)
    return SkyPicture(pixels, tuple(census.findings + shape_findings(pixels, census.highest)))
