"""Colours that no screen can show, and how far a hue is from another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.optics.observer import linear_srgb

SPECTRAL = linear_srgb(np.arange(420, 680, 2.0))
"""Pure spectral colours, all outside the gamut."""


def hue(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angle about the grey axis, degrees."""
    red, green, blue = np.moveaxis(rgb, -1, 0)
    return np.asarray(np.degrees(np.arctan2(np.sqrt(3) * (green - blue), 2 * red - green - blue)))


def turned(before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far the hue has turned, degrees, 0 to 180."""
    return np.abs((hue(after) - hue(before) + 180) % 360 - 180)
