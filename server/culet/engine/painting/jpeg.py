"""Live frames as JPEG."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import PIL.Image
import simplejpeg
from numpy.typing import NDArray

MOVING_QUALITY = 85
RESTING_QUALITY = 92
"""A picture at rest is looked at for long and sent once: 1.5x the bytes of quality 85."""

LEAST_QUALITY = 30
"""Below it a frame of half the size has as few bytes and less error (`culet.study.bytes_ladder`)."""

LOWER_QUALITIES = 85, 75, 65, 50, 40, LEAST_QUALITY
"""Tried one after the other, 3 ms each at 1280x720; each has some 0.83 times the bytes of the one before it."""
SMALLEST = 90
"""Pixels each way, below which no picture is halved."""

SUBSAMPLING = "444"
"""Dispersion is fine, saturated colour, which halved chroma would blur."""


class Encoded(NamedTuple):
    """A JPEG."""

    data: bytes
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    quality: int


def encode_within(rgb: NDArray[np.uint8], quality: int, most_bytes: float) -> Encoded:
    """A JPEG of a (height, width, 3) picture that has so many bytes at most: of a lower quality if need be, and then of
    half the size each way, and so on; with more bytes only if the picture is a few pixels large."""
    height, width, _ = rgb.shape
    for lower in (quality, *(lower for lower in LOWER_QUALITIES if lower < quality)):
        data = encode(rgb, lower)
        if len(data) <= most_bytes:
            return Encoded(data, width, height, lower)
    if min(width, height) < 2 * SMALLEST:
        return Encoded(data, width, height, lower)
    halved = np.asarray(PIL.Image.fromarray(np.ascontiguousarray(rgb)).reduce(2))
    return encode_within(halved, min(quality, MOVING_QUALITY), most_bytes)


def encode(rgb: NDArray[np.uint8], quality: int) -> bytes:
    """A JPEG of a (height, width, 3) picture."""
    data: bytes = simplejpeg.encode_jpeg(
        np.ascontiguousarray(rgb), quality=quality, colorspace="RGB", colorsubsampling=SUBSAMPLING
    )
    return data
