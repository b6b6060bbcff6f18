"""Light through a convex stone as vectors of the electric field, in double precision: no Mueller matrix, no Stokes
parameter, no frame to rotate.

At each boundary a 3 x 3 complex matrix takes the field that comes to the field that goes (G. Yun, K. Crabtree &
R. Chipman, Three-dimensional polarization ray-tracing calculus I, Appl. Opt. 50, 2855 (2011)); their product along a
path, times its own adjoint, is what the path passes of unpolarised light.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from rendering.views import Array

Field = NDArray[np.complex128]


def boundary(k_in: Array, k_out: Array, normal: Array, s_part: complex, p_part: complex) -> Field:
    """Field to field: amplitudes across (s) and within (p) the plane of incidence."""
    across = np.cross(normal, k_in)
    length = np.linalg.norm(across)
    s = across / length if length > 1e-9 else np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    s = s / np.linalg.norm(s)
    return s_part * np.outer(s, s) + p_part * np.outer(np.cross(k_out, s), np.cross(k_in, s))


def amplitudes(cos_i: float, n_i: float, n_t: float) -> tuple[tuple[complex, complex], tuple[complex, complex]]:
    """Reflected and transmitted (s, p), the transmitted ones in units of the root of the power (Born & Wolf, 1.5.2)."""
    cos_t = cmath.sqrt(1 - (n_i / n_t) ** 2 * (1 - cos_i**2))
    a, b, c, d = n_i * cos_i, n_t * cos_t, n_t * cos_i, n_i * cos_t
    reflected = (a - b) / (a + b), (c - d) / (c + d)
    power = cmath.sqrt(b / a) if cos_t.imag == 0 else 0
    return reflected, (2 * a / (a + b) * power, 2 * a / (c + d) * power)


def bent(direction: Array, normal: Array, n_i: float, n_t: float) -> Array | None:
    """Snell's law; the normal is on the side that light comes from. None where all is reflected."""
    ratio, cos_i = n_i / n_t, float(-direction @ normal)
    squared = 1 - ratio**2 * (1 - cos_i**2)
    return None if squared < 0 else ratio * direction + (ratio * cos_i - math.sqrt(squared)) * normal


def seen(
    stone: Shape, eta: float, eye: Array, direction: Array, sky: Callable[[Array], float], averaged: bool = False
) -> float:
    """Radiance along one ray from the eye; `averaged` forgets the polarisation at each boundary."""
    normals, offsets = stone.planes[:, :3], stone.planes[:, 3]
    speed = normals @ direction
    t = np.where(speed < 0, (offsets - normals @ eye) / np.where(speed < 0, speed, 1), -np.inf)
    facet = int(t.argmax())
    point, normal = eye + t[facet] * direction, normals[facet]
    reflected = direction - 2 * (direction @ normal) * normal
    inside = bent(direction, normal, 1, eta)
    assert inside is not None
    # Light runs the other way: from the sky along -reflected, and from inside along -inside.
    way, weight = np.eye(3, dtype=complex), 1.0
    cos_i, cos_t = float(-direction @ normal), float(-inside @ normal)
    (s, p), _ = amplitudes(cos_i, 1, eta)
    radiance = _power(boundary(-reflected, -direction, normal, s, p), (s, p), averaged, 1.0) * sky(reflected)
    _, (s, p) = amplitudes(cos_t, eta, 1)
    weight *= (abs(s) ** 2 + abs(p) ** 2) / 2
    way = boundary(-inside, -direction, normal, s, p)
    direction = inside
    for _ in range(2000):
        speed = normals @ direction
        gap = np.maximum(offsets - normals @ point, 0)
        t = np.where(speed > 1e-14, gap / np.where(speed > 1e-14, speed, 1), np.inf)
        t[facet] = np.inf  # a flat facet is not met twice in a row
        facet = int(t.argmin())
        point, normal = point + t[facet] * direction, normals[facet]
        cos_s = float(direction @ normal)
        back = direction - 2 * cos_s * normal
        out = bent(direction, -normal, eta, 1)
        (s, p), _ = amplitudes(cos_s, eta, 1)
        if out is not None:
            _, through = amplitudes(float(out @ normal), 1, eta)
            total = way @ boundary(-out, -direction, normal, *through)
            radiance += _power(total, through, averaged, weight) * sky(out)
        way = way @ boundary(-back, -direction, normal, s, p)
        weight *= (abs(s) ** 2 + abs(p) ** 2) / 2
        direction = back
        if weight < 1e-14:
            break
    return radiance


def _power(way: Field, last: tuple[complex, complex], averaged: bool, weight: float) -> float:
    """Of unpolarised light at the far end of a path."""
    if averaged:
        return weight * (abs(last[0]) ** 2 + abs(last[1]) ** 2) / 2
    return float((abs(way) ** 2).sum()) / 2
