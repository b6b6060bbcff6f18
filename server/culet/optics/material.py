"""What a stone is made of, as far as light can tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from culet.errors import SceneError
from culet.optics.absorption import AbsorptionSpectrum
from culet.optics.formulas import Formula
from culet.optics.wavelengths import within

INDICES = (1.0, 10.0)
"""Indices of refraction that a transparent solid may have; the same that a scene may give."""


@dataclass(frozen=True)
class Material:
    """A transparent solid."""

    name: str
    title: str
    """What people call it."""
    summary: str
    formula: Formula
    source: str
    span_nm: tuple[float, float]
    """Wavelengths for which the source gives the formula."""
    ray: Literal["ordinary ray"] | None = None
    """Which of two rays the formula is for; None in a cubic crystal or a glass, which have one. Double refraction is
    not traced."""
    confidence: Literal["measured", "weak source", "as set"] = "measured"
    absorption: AbsorptionSpectrum | None = None
    """None: colourless."""
    field: str | None = None
    """Where a scene sets it, for error messages."""

    def index(self, nanometres: ArrayLike, *, clamp: bool = False) -> NDArray[np.float64]:
        """Index of refraction at each wavelength, same shape.

        Outside the source's range: InputError, or with `clamp` the index at the nearer end of it, which flattens the
        dispersion there but invents none. SceneError where the formula gives no index from 1 to 10.
        """
        given = np.asarray(nanometres, dtype=np.float64)
        wavelengths = within(
            np.clip(given, *self.span_nm) if clamp else given,
            self.span_nm,
            self.name,
            "" if clamp else "; with clamp=True the nearer end of the range stands for what lies outside",
        )
        index = self.formula(wavelengths)
        wrong = ~((index >= INDICES[0]) & (index <= INDICES[1]))
        if wrong.any():
            raise SceneError(
                f"{self.field or self.name}: expected an index from 1 to 10, "
                f"got {index[wrong][0]:g} at {wavelengths[wrong][0]:g} nm",
                self.field,
            )
        return index

    def absorption_per_mm(self, nanometres: ArrayLike) -> NDArray[np.float64]:
        """Absorption coefficient, 1/mm (Napierian), of each wavelength; a coloured one refuses what is not visible."""
        if self.absorption is None:
            return np.zeros_like(np.asarray(nanometres, dtype=np.float64))
        return self.absorption.per_mm(nanometres)

    def absorption_rgb_per_mm(self) -> tuple[float, float, float]:
        """Absorption coefficients of the three channels, 1/mm, for the mode with three indices."""
        return (0.0, 0.0, 0.0) if self.absorption is None else self.absorption.rgb_per_mm()
