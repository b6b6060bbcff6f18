"""What was read of a sky's file, and the checks that all formats share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError, TooLargeError
from culet.optics.panoramas import Panorama

MOST_PIXELS = 2**25
"""Of a sky that is read, unless told otherwise: 8192 x 4096, which take 384 MiB."""

DARKEST_PART = 0.05
"""Values below 0 by more than this part of the brightest are no rounding and no noise of a camera."""
NEGATIVE_LIGHT = 0.01
"""Nor are values below 0 that sum up to more than this part of all light."""

Allocate = Callable[[tuple[int, int, int]], Panorama]
"""Makes the array that a sky is read into."""


@dataclass(frozen=True, eq=False)
class SkyPicture:
    """What a file of a sky held."""

    pixels: Panorama
    findings: tuple[str, ...] = ()
    """What was found in the file and what was done about it, a sentence each."""


def new_panorama(shape: tuple[int, int, int]) -> Panorama:
    """A black panorama of (height, width, 3); the system gives its memory when it is written."""
    return np.zeros(shape, np.float32)


def check_size(width: int, height: int, most_pixels: int) -> None:
    """InputError for a picture too small to be a sky, TooLargeError for one of too many pixels."""
    if width * height > most_pixels:
        raise TooLargeError(f"expected a sky of at most {most_pixels} pixels, got {width} x {height}", "file")
    if width < 2 or height < 1:
        raise InputError(f"expected a sky of at least 2 x 1 pixels, got {width} x {height}", "file")


@dataclass
class Census:
    """Counts, while rows are read, what a panorama may not hold."""

    not_finite: int = 0
    first_not_finite: tuple[int, int] = (0, 0)
    """Column and row."""
    below_zero: int = 0
    lowest: float = 0.0
    highest: float = 0.0
    light: float = 0.0
    """Sum of the values above 0."""
    missing_light: float = 0.0
    """Sum of the values below 0, as a positive number."""
    findings: list[str] = field(default_factory=list)

    def count(self, rows: NDArray[np.float32], first_row: int) -> None:
        """Look at some rows, (n, width, 3)."""
        low, high = float(rows.min()), float(rows.max())  # NaN if there is one
        if not (np.isfinite(low) and np.isfinite(high)):
            bad = ~np.isfinite(rows)
            if self.not_finite == 0:
                row, column, _ = np.argwhere(bad)[0]
                self.first_not_finite = int(column), first_row + int(row)
            self.not_finite += int(bad.sum())
            return
        self.lowest, self.highest = min(self.lowest, low), max(self.highest, high)
        total = float(rows.sum(dtype=np.float64))
        if low < 0:
            below = rows[rows < 0]
            self.below_zero += below.size
            missing = -float(below.sum(dtype=np.float64))
            self.missing_light += missing
            total += missing
        self.light += total

    def settle(self, pixels: Panorama) -> None:
        """Set small values below 0 to 0 and say so; InputError for large ones, and for values that are not finite."""
        if self.not_finite:
            column, row = self.first_not_finite
            raise InputError(
                f"expected a sky of finite radiance; {self.not_finite} of {pixels.size} values are NaN or infinite, "
                f"the first at column {column}, row {row}",
                "file",
            )
        if not self.below_zero:
            return
        if -self.lowest > DARKEST_PART * self.highest or self.missing_light > NEGATIVE_LIGHT * self.light:
            raise InputError(
                f"expected a sky of radiance not below 0; {self.below_zero} of {pixels.size} values are below 0, down "
                f"to {self.lowest:.3g} where the brightest is {self.highest:.3g}; small ones would be set to 0",
                "file",
            )
        np.maximum(pixels, 0, out=pixels)
        self.findings.append(
            f"The picture had {self.below_zero} values below 0 (the lowest {self.lowest:.2g}, the brightest "
            f"{self.highest:.3g}), set to 0."
        )


def shape_findings(pixels: Panorama, brightest: float) -> list[str]:
    """What whoever made a panorama may not have meant."""
    height, width, _ = pixels.shape
    found = []
    if width != 2 * height:
        found.append(f"{width} x {height} pixels are stretched over all directions, which need twice the width.")
    if brightest <= 0:
        found.append("All of it is black.")
    return found
