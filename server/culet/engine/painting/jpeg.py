"""Live frames as JPEG."""

from __future__ import annotations

import numpy as np
import simplejpeg
from numpy.typing import NDArray

MOVING_QUALITY = 85
RESTING_QUALITY = 92
"""A picture at rest is looked at for long and sent once: 1.5x the bytes of quality 85."""

SUBSAMPLING = "444"
"""Dispersion is fine, saturated colour, which halved chroma would blur."""


def encode(rgb: NDArray[np.uint8], *, moving: bool) -> bytes:
    """A JPEG of a (height, width, 3) picture."""
    quality = MOVING_QUALITY if moving else RESTING_QUALITY
    data: bytes = simplejpeg.encode_jpeg(
        np.ascontiguousarray(rgb), quality=quality, colorspace="RGB", colorsubsampling=SUBSAMPLING
    )
    return data
