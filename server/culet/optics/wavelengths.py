"""Wavelengths in vacuum, in nanometres: the lines that are quoted, and refusing what lies outside a range."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from culet.errors import InputError

RGB_NANOMETRES = (656.3, 546.1, 435.8)
"""Wavelengths that stand for the three channels: the Fraunhofer lines C (hydrogen) and e (mercury), and mercury's g."""

LINE_G, LINE_F, LINE_D, LINE_C, LINE_B = 430.8, 486.1327, 587.5618, 656.2725, 686.7
"""Fraunhofer's lines G, F, d, C and B. n_F - n_C is the optician's dispersion, n_G - n_B the gemmologist's."""


def within(nanometres: ArrayLike, span: tuple[float, float], what: str, advice: str = "") -> NDArray[np.float64]:
    """The wavelengths as float64, any shape; InputError that names the first one outside `span` (or not a number)."""
    given = np.asarray(nanometres, dtype=np.float64)
    low, high = span
    outside = given[~((given >= low) & (given <= high))]
    if outside.size:
        raise InputError(f"{what}: expected wavelengths from {low:g} to {high:g} nm, got {outside[0]:g} nm{advice}")
    return given
