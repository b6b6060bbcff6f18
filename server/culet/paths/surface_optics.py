"""What a stone's surface does to light at an angle: Snell's law and Fresnel's equations for one index against air (Born
& Wolf, Principles of Optics, 1.5.2 and 1.5.3)."""

from __future__ import annotations

import math

from culet.paths.answer import Reflectance


def reflectance(cos_air: float, cos_stone: float, index: float) -> Reflectance:
    """From either side; total where `cos_air` is 0, as for angles beyond the critical one."""
    s = ((cos_air - index * cos_stone) / (cos_air + index * cos_stone)) ** 2 if cos_air + cos_stone > 0 else 1.0
    p = ((index * cos_air - cos_stone) / (index * cos_air + cos_stone)) ** 2 if cos_air + cos_stone > 0 else 1.0
    return Reflectance(s, p, (s + p) / 2)


def cosine_in_stone(cos_air: float, index: float) -> float:
    """Of light that comes from air at an angle of that cosine: sin(air) = index sin(stone)."""
    return math.sqrt(max(0.0, 1 - (1 - cos_air * cos_air) / index**2))


def cosine_in_air(cos_stone: float, index: float) -> float:
    """Of light that comes from inside; 0 where it is totally reflected."""
    return math.sqrt(max(0.0, 1 - index**2 * (1 - cos_stone * cos_stone)))


def critical_degrees(index: float) -> float:
    """From the normal, inside: sin = 1 / index."""
    return math.degrees(math.asin(1 / index))


def brewster_degrees(index: float) -> float:
    """From the normal, in air: tan = index; there nothing of p is reflected."""
    return math.degrees(math.atan(index))


def degrees(cosine: float) -> float:
    """Of an angle from 0 to 180."""
    return math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
