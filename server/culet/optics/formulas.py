"""Published forms of the dispersion of transparent solids: the index of refraction as a function of wavelength.

Wavelengths come in nanometres; inside, as in the literature, l is in micrometres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Formula(Protocol):
    """An index of refraction for each wavelength, same shape; NaN or infinity where the formula has none."""

    def __call__(self, nanometres: ArrayLike) -> NDArray[np.float64]: ...


def _square_micrometres(nanometres: ArrayLike) -> NDArray[np.float64]:
    return np.asarray((np.asarray(nanometres, dtype=np.float64) / 1000) ** 2)


def sellmeier(pairs: Sequence[tuple[float, float]], nanometres: ArrayLike, constant: float = 1) -> NDArray[np.float64]:
    """n from n^2 = constant + sum B l^2 / (l^2 - C^2), pairs (B, C), C in micrometres; NaN where n^2 < 0."""
    square = _square_micrometres(nanometres)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # at a resonance, and where there is no index
        return np.sqrt(sum((b * square / (square - c * c) for b, c in pairs), start=np.full_like(square, constant)))


@dataclass(frozen=True)
class Sellmeier:
    """n^2 = constant + sum B l^2 / (l^2 - C^2) (Sellmeier 1871). A constant above 1 stands for far terms."""

    pairs: tuple[tuple[float, float], ...]
    constant: float = 1

    @classmethod
    def of_squares(cls, *pairs: tuple[float, float], constant: float = 1) -> Sellmeier:
        """From pairs (B, C^2), as glass makers print them."""
        return cls(tuple((b, c_squared**0.5) for b, c_squared in pairs), constant)

    def __call__(self, nanometres: ArrayLike) -> NDArray[np.float64]:
        return sellmeier(self.pairs, nanometres, self.constant)


@dataclass(frozen=True)
class SinglePole:
    """n^2 = a + b / (l^2 - c) - d l^2, as DeVore 1951 (without d) and Wang 2013 print it; c in square micrometres."""

    a: float
    b: float
    c: float
    d: float = 0

    def __call__(self, nanometres: ArrayLike) -> NDArray[np.float64]:
        square = _square_micrometres(nanometres)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.sqrt(self.a + self.b / (square - self.c) - self.d * square)


@dataclass(frozen=True)
class Cauchy:
    """n = a + b / l^2 (Cauchy 1836), b in square micrometres."""

    a: float
    b: float

    def __call__(self, nanometres: ArrayLike) -> NDArray[np.float64]:
        return np.asarray(self.a + self.b / _square_micrometres(nanometres))


@dataclass(frozen=True)
class ThroughLines:
    """Through given indices at given wavelengths, each neighbouring pair joined by Cauchy's n = a + b / l^2.

    Beyond the outermost lines the index stays what it is there: so it never leaves the given ones, however odd they
    are. (One polynomial in 1/l^2 through 1.7, 1.8, 1.9 turns over in the violet, and through 3, 1, 3 falls below 1.)
    """

    nanometres: tuple[float, ...]
    indices: tuple[float, ...]

    def __call__(self, nanometres: ArrayLike) -> NDArray[np.float64]:
        abscissa, lines = 1 / _square_micrometres(nanometres), 1 / _square_micrometres(self.nanometres)
        order = np.argsort(lines)
        return np.asarray(np.interp(abscissa, lines[order], np.asarray(self.indices)[order]), dtype=np.float64)
