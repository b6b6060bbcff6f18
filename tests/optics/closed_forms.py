"""Optics of flat boundaries in closed form, in double precision, written from the textbook and not from the kernels."""

from __future__ import annotations

import math

DIAMOND = 2.41749
"""n_d, at 587.56 nm, from F. Peter, Z. Phys. 15, 358 (1923)."""


def fresnel(sin_i: float, n_i: float, n_t: float) -> float:
    """Reflectance of unpolarised light (Born & Wolf, Principles of Optics, 1.5.2, eq. 21a): by angles, not cosines."""
    if sin_i == 0:
        return ((n_i - n_t) / (n_i + n_t)) ** 2
    sin_t = n_i * sin_i / n_t
    if sin_t >= 1:
        return 1
    i, t = math.asin(sin_i), math.asin(sin_t)
    r_s, r_p = math.sin(i - t) / math.sin(i + t), math.tan(i - t) / math.tan(i + t)
    return (r_s**2 + r_p**2) / 2


def slab(reflectance: float, passage: float = 1) -> tuple[float, float]:
    """Transmittance and reflectance of a plate in incoherent light, by summing its echoes; `passage` is what is left
    of light that has crossed it once."""
    t, r = 1 - reflectance, reflectance
    echoes = 1 / (1 - (r * passage) ** 2)
    return t * t * passage * echoes, r + r * (t * passage) ** 2 * echoes


def deviation(n: float, apex: float, incidence: float) -> float:
    """Angle by which a prism turns a ray in its principal plane, radians."""
    inner = apex - math.asin(math.sin(incidence) / n)
    return incidence + math.asin(n * math.sin(inner)) - apex


def minimum_deviation(n: float, apex: float) -> float:
    """The same for the symmetric passage, which is the least (Born & Wolf, 4.7.2)."""
    return 2 * math.asin(n * math.sin(apex / 2)) - apex
