"""Absorption spectra of coloured stones as sums of Gaussian bands, and what they come to in red, green and blue.

Coefficients a are Napierian, per millimetre: what is left after a path of s mm is exp(-a s) (Beer and Lambert).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from culet.optics.bands import bands
from culet.optics.wavelengths import within

SPAN_NANOMETRES = (380.0, 780.0)
"""Where the sums of bands are meant to hold; the ultraviolet edge and the infrared lines are not in them."""

MATCHED_PATH_MM = 5.0
"""Path after which three RGB coefficients leave the colour that the spectrum leaves: a few crossings of a stone of one
carat. On shorter paths they are a little too weak or strong, on longer ones too saturated: it is the cheap mode. Linear
sRGB of 2 mm is off by 0.12 for ruby, by less than 0.05 for sapphire and emerald; that of 10 mm by less than 0.08."""

LEAST_TRANSMITTANCE = 1e-3
"""What a channel keeps after that path, at least: a colour outside the gamut would need an infinite coefficient."""

_BANDS_OF_1_NM = 310


@dataclass(frozen=True)
class GaussianBand:
    """One absorption band. It is Gaussian in wavenumber, as broad bands of ions in crystals are."""

    centre_nm: float
    width_per_cm: float
    """Full width at half maximum, 1/cm."""
    peak_per_mm: float

    def per_mm(self, nanometres: NDArray[np.float64]) -> NDArray[np.float64]:
        """Absorption coefficient, 1/mm, of each wavelength."""
        distance = (1e7 / nanometres - 1e7 / self.centre_nm) / self.width_per_cm
        return np.asarray(self.peak_per_mm * np.exp(-4 * np.log(2) * distance**2))


@dataclass(frozen=True)
class AbsorptionSpectrum:
    """A sum of bands."""

    bands: tuple[GaussianBand, ...]
    source: str
    """Where the bands' positions are published. Their widths and heights are chosen for the colour, not measured."""

    def per_mm(self, nanometres: ArrayLike) -> NDArray[np.float64]:
        """Absorption coefficient, 1/mm, same shape; InputError outside 380 to 780 nm."""
        given = within(nanometres, SPAN_NANOMETRES, "absorption")
        return np.asarray(sum((band.per_mm(given) for band in self.bands), start=np.zeros_like(given)))

    def colour_after(self, path_mm: float) -> NDArray[np.float64]:
        """(3,) linear sRGB of white light after a path, without reflection."""
        every = bands(_BANDS_OF_1_NM)
        return np.asarray(np.exp(-path_mm * self.per_mm(every.wavelength)) @ every.weights)

    def rgb_per_mm(self) -> tuple[float, float, float]:
        """Coefficients of the three channels, 1/mm, that leave the spectrum's colour after MATCHED_PATH_MM."""
        red, green, blue = _matched(self)
        return red, green, blue


@cache
def _matched(spectrum: AbsorptionSpectrum) -> tuple[float, ...]:
    """-ln of the transmittance that each channel sees, over the path; none is negative."""
    seen = np.clip(spectrum.colour_after(MATCHED_PATH_MM), LEAST_TRANSMITTANCE, 1)
    return tuple((-np.log(seen) / MATCHED_PATH_MM).tolist())
