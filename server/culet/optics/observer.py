"""What an eye sees of a wavelength: the CIE 1931 observer of 2 degrees, and the linear sRGB that shows it.

The colour-matching functions are CIE 018:2019's table at every 5 nm, linearly interpolated between them. sRGB's matrix
is computed from the chromaticities of IEC 61966-2-1 (its printed four decimals would tint white by 2e-4).
"""

from __future__ import annotations

from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import ArrayLike, NDArray

from culet.optics.wavelengths import within

SPAN_NANOMETRES = (360.0, 830.0)
"""Where the observer is tabulated; outside it the eye sees nothing."""

PRIMARIES_XY = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
"""Chromaticities of sRGB's red, green and blue (IEC 61966-2-1, the primaries of ITU-R BT.709)."""

WHITE_XY = (0.3127, 0.3290)
"""Chromaticity of sRGB's white, D65 as IEC 61966-2-1 rounds it."""


def _xyz(x: float, y: float) -> tuple[float, float, float]:
    """Tristimulus values of unit luminance."""
    return x / y, 1, (1 - x - y) / y


def _rgb_to_xyz() -> NDArray[np.float64]:
    primaries = np.array([_xyz(*p) for p in PRIMARIES_XY]).T
    return np.asarray(primaries * np.linalg.solve(primaries, np.array(_xyz(*WHITE_XY))))


RGB_TO_XYZ = _rgb_to_xyz()
"""(3, 3) linear sRGB -> CIE XYZ, Y of white = 1."""

XYZ_TO_RGB = np.linalg.inv(RGB_TO_XYZ)
"""(3, 3) CIE XYZ -> linear sRGB."""

LUMINANCE = RGB_TO_XYZ[1]
"""(3,) luminance of linear sRGB's components: 0.212639, 0.715169, 0.072192."""


@cache
def colour_matching_table() -> NDArray[np.float64]:
    """(95, 4) rows of nanometres, xbar, ybar, zbar. Read-only."""
    text = resources.files("culet.optics").joinpath("cie_1931_2_degree_5nm.csv").read_text(encoding="ascii")
    table = np.loadtxt(text.splitlines(), delimiter=",")
    table.setflags(write=False)
    return table


def colour_matching(nanometres: ArrayLike) -> NDArray[np.float64]:
    """(..., 3) xbar, ybar, zbar of the wavelengths; InputError outside 360 to 830 nm."""
    given = within(nanometres, SPAN_NANOMETRES, "CIE 1931 observer")
    lines, *functions = colour_matching_table().T
    return np.stack([np.interp(given, lines, f) for f in functions], axis=-1)


def linear_srgb(nanometres: ArrayLike) -> NDArray[np.float64]:
    """(..., 3) linear sRGB of unit radiance per nanometre: negative where the gamut does not reach the wavelength."""
    return np.asarray(colour_matching(nanometres) @ XYZ_TO_RGB.T)
