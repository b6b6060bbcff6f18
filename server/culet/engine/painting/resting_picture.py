"""Pictures at rest as they are sent: the final one without loss, or with as little as the viewer's link has room for.

A picture at rest is refined until what is shown is off by 0.004 (root mean square); a JPEG of quality 92 alone is off
by 0.008.
"""

from __future__ import annotations

import io

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.engine.governing.thrift import ByteAllowance
from culet.engine.painting import jpeg
from culet.engine.painting.coded import Coded
from culet_protocol.frame import Codec

LOSSLESS_QUALITY = 100
"""Of a PNG, as `Coded` counts it."""
COMPRESSION = 6
"""Of zlib. The default scene at 960x540 has 254 kB in 29 ms; at level 1 346 kB in 11 ms, as lossless WebP 229 kB in
10 ms, for which every reader of frames would need another decoder."""
FINER_QUALITIES = 99, 97
"""Of JPEG, where a PNG is too large; off by 0.0025 and 0.0042 at 2.5 and 1.7 times the bytes of quality 92."""
LEAST_TIMES = 2
"""Bytes of a PNG over those of the JPEG of quality 92, at least: where not even so many may be sent, none is made."""


def encode_resting(rgb: NDArray[np.uint8], allowance: ByteAllowance, *, final: bool) -> Coded:
    """A (height, width, 3) picture that does not move, within what the link allows. Takes milliseconds, a final one
    some hundredths of a second."""
    if final and allowance.at_rest is None:
        return _without_loss(rgb)
    picture = jpeg.encode_within(rgb, jpeg.RESTING_QUALITY, allowance.resting(final=final))
    thrifty = picture.quality < jpeg.RESTING_QUALITY
    fine = _finer(rgb, len(picture.data), allowance.resting(final=False)) if final and not thrifty else None
    return fine or Coded.of_jpeg(picture, thrifty=thrifty)


def _finer(rgb: NDArray[np.uint8], count: int, most_bytes: float) -> Coded | None:
    """With less loss than the JPEG of quality 92, which has so many bytes. None: the link has no room for that."""
    height, width, _ = rgb.shape
    if LEAST_TIMES * count <= most_bytes:
        lossless = _without_loss(rgb)
        if len(lossless.data) <= most_bytes:
            return lossless
    for quality in FINER_QUALITIES:
        if count < most_bytes and len(data := jpeg.encode(rgb, quality)) <= most_bytes:
            return Coded(Codec.JPEG, data, width, height, quality, thrifty=False)
    return None


def _without_loss(rgb: NDArray[np.uint8]) -> Coded:
    height, width, _ = rgb.shape
    return Coded(Codec.PNG, encode_png(rgb), width, height, LOSSLESS_QUALITY, thrifty=False)


def encode_png(rgb: NDArray[np.uint8]) -> bytes:
    """A PNG of a (height, width, 3) picture."""
    file = io.BytesIO()
    PIL.Image.fromarray(np.ascontiguousarray(rgb)).save(file, "PNG", compress_level=COMPRESSION)
    return file.getvalue()
