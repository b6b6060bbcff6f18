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
"""Below it a frame of half the size has as few bytes and less error (`culet.study.stream.bytes_ladder`)."""

LOWER_QUALITIES = 85, 75, 65, 50, 40, LEAST_QUALITY
"""3 ms each at 1280x720; each has some 0.83 times the bytes of the one before it."""
FAR_TOO_MANY = 2
"""Times the bytes that a picture may have, from which on the least quality is tried before those between: from the best
to the least there is a factor of three. A first picture of 990x800 has five times what a link of which nothing is known
may have."""
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
    chosen, data = quality, encode(rgb, quality)
    lower = [lower for lower in LOWER_QUALITIES if lower < quality]
    if lower and len(data) > FAR_TOO_MANY * most_bytes:
        least = encode(rgb, lower[-1])
        if len(least) > most_bytes:  # and so are those of all qualities between
            chosen, data, lower = lower[-1], least, []
    while len(data) > most_bytes and lower:
        chosen = lower.pop(0)
        data = encode(rgb, chosen)
    if len(data) <= most_bytes or min(width, height) < 2 * SMALLEST:
        return Encoded(data, width, height, chosen)
    halved = np.asarray(PIL.Image.fromarray(np.ascontiguousarray(rgb)).reduce(2))
    return encode_within(halved, min(quality, MOVING_QUALITY), most_bytes)


def encode(rgb: NDArray[np.uint8], quality: int) -> bytes:
    """A JPEG of a (height, width, 3) picture."""
    data: bytes = simplejpeg.encode_jpeg(
        np.ascontiguousarray(rgb), quality=quality, colorspace="RGB", colorsubsampling=SUBSAMPLING
    )
    return data
