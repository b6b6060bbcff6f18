"""Linear sRGB that no screen can show: components below 0 (spectral colours), or above a ceiling.

    clip        each component by itself: shifts hue and adds light
    desaturate  towards grey of the same luminance, only as far as it takes: keeps luminance and hue

A colour without luminance (or with less) is black to desaturate: there is no grey to go to. The kernel's film.cl
mirrors these references.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.observer import LUMINANCE


def clip(rgb: NDArray[np.float64], ceiling: float = np.inf) -> NDArray[np.float64]:
    """(..., 3) linear sRGB, each component from 0 to `ceiling`."""
    return np.clip(rgb, 0, ceiling)


def desaturate(rgb: NDArray[np.float64], ceiling: float = np.inf) -> NDArray[np.float64]:
    """(..., 3) linear sRGB, moved towards the grey of its luminance until every component is from 0 to `ceiling`.

    With Y the luminance and c a component, the largest s for which 0 <= Y + s (c - Y) <= ceiling. A luminance above
    the ceiling is white.
    """
    luminance = np.clip(rgb @ LUMINANCE, 0, ceiling)[..., None]
    lowest, highest = rgb.min(axis=-1, keepdims=True), rgb.max(axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):  # not taken where the denominator is 0
        from_below = np.where(lowest < 0, luminance / (luminance - lowest), 1)
        from_above = np.where(highest > ceiling, (ceiling - luminance) / (highest - luminance), 1)
    saturation = np.minimum(from_below, from_above)
    moved = luminance + saturation * (rgb - luminance)
    return np.asarray(np.clip(moved, 0, ceiling))  # rounding leaves 1e-17 below


GAMUT_METHODS: Mapping[str, Callable[[NDArray[np.float64]], NDArray[np.float64]]] = MappingProxyType(
    {"clip": clip, "desaturate": desaturate}
)
"""By name."""


def into_gamut(rgb: NDArray[np.float64], method: str = "desaturate") -> NDArray[np.float64]:
    """(..., 3) linear sRGB without negative components; InputError for a method that has no name here."""
    if method not in GAMUT_METHODS:
        raise InputError(f"gamut: expected one of {', '.join(GAMUT_METHODS)}, got {method!r}", "film.gamut")
    return GAMUT_METHODS[method](rgb)
