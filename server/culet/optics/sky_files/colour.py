"""Colours of other primaries and whites, as Rec. 709's, which the renderer's red, green and blue are.

The matrix from primaries to CIE XYZ is that of SMPTE RP 177-1993; whites are adapted by Bradford's method (K. M. Lam,
Metamerism and Colour Constancy, 1985; its matrix as in ICC.1:2022, annex E).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.gamut import desaturate
from culet.optics.observer import LUMINANCE

Chromaticity = tuple[float, float]
"""x and y of CIE 1931."""


class Primaries(NamedTuple):
    """Chromaticities of a colour space."""

    red: Chromaticity
    green: Chromaticity
    blue: Chromaticity
    white: Chromaticity

    def same(self, other: Primaries) -> bool:
        """Whether they are equal, but for the digits that files leave out."""
        return bool(np.allclose(self, other, rtol=0, atol=SAME))


SAME = 2e-3
"""Files give D65 as 0.3127, 0.329 or as 0.313, 0.329."""

D65: Chromaticity = (0.3127, 0.3290)
REC_709 = Primaries((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), D65)
CIE_XYZ = Primaries((1, 0), (0, 1), (0, 0), (1 / 3, 1 / 3))
"""The axes of XYZ themselves: values of such a picture are absolute, so no white is adapted."""
RADIANCE = Primaries((0.640, 0.330), (0.290, 0.600), (0.150, 0.060), (1 / 3, 1 / 3))
"""What Radiance takes for a picture that names none. Pictures that name them, or none, are taken for Rec. 709, as every
program that reads skies does."""
NAMES = {
    "CIE XYZ": CIE_XYZ,
    "Display P3": Primaries((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), D65),
    "Rec. 2020": Primaries((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65),
    "Adobe RGB": Primaries((0.64, 0.33), (0.21, 0.71), (0.15, 0.06), D65),
    "ACES AP0": Primaries((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770), (0.32168, 0.33767)),
    "ACES AP1": Primaries((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), (0.32168, 0.33767)),
}

BRADFORD = np.array([(0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)])

ROUNDING = 2e-3
"""Part of a colour's largest component: less below 0 comes of the eleven bits of half precision, not of a colour that
Rec. 709 does not have."""

Matrix = NDArray[np.float64]


def name_of(primaries: Primaries) -> str:
    """As people call them, or else their numbers."""
    known = next((name for name, each in NAMES.items() if each.same(primaries)), None)
    return known or ", ".join(f"{x:.4g} {y:.4g}" for x, y in primaries)


def to_xyz(primaries: Primaries) -> Matrix:
    """(3, 3): the colour's components to X, Y, Z, white's Y being 1. InputError if they span no colours."""
    try:
        columns = np.array([_xyz(point) for point in primaries[:3]]).T
        return np.asarray(columns * np.linalg.solve(columns, _xyz(primaries.white)))
    except (np.linalg.LinAlgError, ZeroDivisionError):
        raise InputError(f"expected primaries that span colours, got {name_of(primaries)}", "file") from None


def to_rec709(primaries: Primaries, neutral: Chromaticity | None = None) -> Matrix | None:
    """(3, 3): colours of these primaries to Rec. 709's, their white (or what is `neutral`) to its white.

    None if there is nothing to convert.
    """
    if primaries.same(REC_709) and neutral in (None, primaries.white):
        return None
    absolute = primaries.same(CIE_XYZ) and neutral is None
    adapted = np.eye(3) if absolute else _adaptation(neutral or primaries.white, D65)
    matrix = np.linalg.inv(to_xyz(REC_709)) @ adapted @ to_xyz(primaries)
    if not np.isfinite(matrix).all():
        raise InputError(f"expected primaries that span colours, got {name_of(primaries)}", "file")
    return np.asarray(matrix)


def converted(rows: NDArray[np.float32], matrix: Matrix) -> tuple[NDArray[np.float32], int]:
    """Colours (n, width, 3) by the matrix, and how many of them Rec. 709 cannot have.

    Those go to the edge of what it has, at their luminance.
    """
    result = rows.astype(np.float64) @ matrix.T
    rounding = ROUNDING * np.abs(result).max(axis=-1, keepdims=True)
    visible = (result @ LUMINANCE > 0)[..., None] & (rows >= 0).all(axis=-1, keepdims=True)
    outside = (result < -rounding).any(axis=-1, keepdims=True) & visible
    if outside.any():
        result = np.where(outside, desaturate(result), result)
    result = np.where((result < 0) & (result >= -rounding), 0, result)
    return result.astype(np.float32), int(outside.sum())


def conversion_finding(name: str, outside: int) -> str:
    """What to say of a converted picture."""
    moved = f"; {outside} pixels had colours beyond it and took its nearest of their luminance" if outside else ""
    return f"Colours were converted from {name} to Rec. 709{moved}."


def _xyz(point: Chromaticity) -> NDArray[np.float64]:
    x, y = point
    return np.array([x / y, 1, (1 - x - y) / y]) if y else np.array([x, y, 1 - x - y])


def _adaptation(white: Chromaticity, target: Chromaticity) -> Matrix:
    seen, wanted = BRADFORD @ _xyz(white), BRADFORD @ _xyz(target)
    return np.asarray(np.linalg.inv(BRADFORD) @ np.diag(wanted / seen) @ BRADFORD)
