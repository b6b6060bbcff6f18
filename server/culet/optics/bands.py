"""Wavelengths to trace, and the linear sRGB that each one's radiance is worth.

The visible range is cut into strata of equal width, one wavelength in each. A pixel may take only every k-th one (its
group), so that a few wavelengths per pixel converge over pixels and frames. In each group the weights are divided,
component by component, by their sum (von Kries in sRGB): an equal-energy spectrum is (1, 1, 1) whatever the number, the
group and the offset. So a colourless scene stays colourless, and RGB radiance can multiply the weights by component.

That division makes each group a ratio of two estimates: few wavelengths are slightly biased, by less and less as they
grow in number. How much is measured in tests/optics/test_bands.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.observer import linear_srgb

SPAN_NANOMETRES = (390.0, 700.0)
"""The range of the strata. It holds 99.6 % of the observer's red, 99.9 % of its green and 99.8 % of its blue. A wider
one sends bands where the eye hardly sees: of 360 to 830 nm, 4 wavelengths can catch 3 % of the blue that is there, here
47 %. A narrower one loses the ends of the spectrum, which are the ends of the fire."""

FEWEST = 4
"""Wavelengths of a group, at least. Over all offsets the largest weight is 1.32 with 4, 1.19 with 5, 0.82 with 8. 3
reach 1.77 and can catch 18 % of the blue that is there, which the division then blows up: RGB indices serve better."""

MOST = 4096
"""Strata in all, at most: 0.08 nm each, far below what the observer's table resolves."""


@dataclass(frozen=True)
class Bands:
    """M = count x groups wavelengths, ascending. Arrays are read-only."""

    wavelength: NDArray[np.float64]
    """(M,) nanometres."""
    group: NDArray[np.int32]
    """(M,) which group traces it: stratum modulo groups, so that each group's neighbours are those of the others."""
    weights: NDArray[np.float64]
    """(M, 3) linear sRGB of unit radiance; those of each group sum to (1, 1, 1)."""


def bands(count: int, offset: float = 0.5, groups: int = 1) -> Bands:
    """`count` wavelengths for each of `groups`, at `offset` (0 to 1) of each stratum's width.

    InputError for fewer than FEWEST, more than MOST in all, no group, or an offset that is not from 0 to 1.
    """
    if count < FEWEST:
        raise InputError(f"bands: expected at least {FEWEST} wavelengths in a group, got {count}")
    if groups < 1:
        raise InputError(f"groups: expected at least 1, got {groups}")
    strata = count * groups
    if strata > MOST:
        raise InputError(f"bands x groups: expected at most {MOST}, got {count} x {groups} = {strata}")
    if not 0 <= offset <= 1:
        raise InputError(f"offset: expected from 0 to 1, got {offset}")
    low, high = SPAN_NANOMETRES
    stratum = np.arange(strata)
    wavelength = np.asarray(low + (stratum + offset) * ((high - low) / strata), dtype=np.float64)
    by_group = linear_srgb(wavelength).reshape(count, groups, 3)
    weights = (by_group / by_group.sum(axis=0)).reshape(strata, 3)
    group = (stratum % groups).astype(np.int32)
    for array in (wavelength, group, weights):
        array.setflags(write=False)
    return Bands(wavelength, group, weights)
