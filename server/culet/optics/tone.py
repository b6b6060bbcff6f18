"""Tone maps: from linear radiance, exposed, to what a screen is sent, from 0 to 1.

    srgb     IEC 61966-2-1, exact; what is above 1 is clipped
    neutral  as it is up to 0.8, then a shoulder that brightness never climbs over, turning white; then srgb
    filmic   Hable's curve on the luminance, hue kept, then srgb
    classic  (1.2 L)^1.2, the report's
    none     linear

Negative components are clipped, but by filmic desaturated. These are the references of film.cl, in double precision.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from culet.errors import InputError
from culet.optics.gamut import desaturate
from culet.optics.observer import LUMINANCE

# J. Hable, Filmic Tonemapping Operators (2010), filmicworlds.com/blog/filmic-tonemapping-operators: shoulder, linear
# strength and angle, toe strength, numerator and denominator, the white point, and the exposure before the curve.
SHOULDER, LINEAR, ANGLE, TOE, TOE_NUMERATOR, TOE_DENOMINATOR = 0.15, 0.50, 0.10, 0.20, 0.02, 0.30
LINEAR_WHITE = 11.2
EXPOSURE_BIAS = 2.0

FILMIC_WHITE = LINEAR_WHITE / EXPOSURE_BIAS
"""Luminance that is shown as 1: 5.6."""


def encode_srgb(linear: ArrayLike) -> NDArray[np.float64]:
    """IEC 61966-2-1's transfer function, of values from 0 to 1."""
    x = np.asarray(linear, dtype=np.float64)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055)


def _hable(x: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Published as (x (A x + C B) + D E) / (x (A x + B) + D F) - E / F; on one denominator D E cancels, and with it the
    rounding that the difference leaves in the dark."""
    foot = TOE_NUMERATOR / TOE_DENOMINATOR
    above = x * (SHOULDER * (1 - foot) * x + LINEAR * (ANGLE - foot))
    below = x * (SHOULDER * x + LINEAR) + TOE * TOE_DENOMINATOR
    return np.asarray(above / below)


def filmic_curve(luminance: ArrayLike) -> NDArray[np.float64]:
    """Luminance 0 and above to 0..1: 0 stays 0, FILMIC_WHITE and what is brighter become 1."""
    x = np.minimum(EXPOSURE_BIAS * np.asarray(luminance, dtype=np.float64), LINEAR_WHITE)
    return np.asarray(_hable(x) / _hable(LINEAR_WHITE))


def _srgb(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    return encode_srgb(np.clip(rgb, 0, 1))


def _filmic(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """The curve acts on luminance and the colour is scaled with it, so that bright fire keeps its hue, which a curve on
    each component would turn towards yellow, cyan and magenta. What then is below 0 or above 1 is desaturated just
    enough."""
    luminance = np.maximum(rgb @ LUMINANCE, 0)[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.where(luminance > 0, filmic_curve(luminance) / luminance, 0)
    return encode_srgb(desaturate(scale * rgb, ceiling=1))


COMPRESSED = 0.8
"""Largest component from which on neutral compresses."""
WHITENING = 0.15
"""How fast what is held back turns a colour white."""


def _neutral(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Khronos PBR Neutral (2024, github.com/KhronosGroup/ToneMapping) without its offset, which serves glossy paint:
    what is below COMPRESSED stays as it is, so that the colours of a product do."""
    kept = np.maximum(rgb, 0)
    peak = kept.max(axis=-1, keepdims=True)
    above, room = np.maximum(peak - COMPRESSED, 0), 1 - COMPRESSED
    lowered = np.where(above > 0, COMPRESSED + above * room / (above + room), peak)
    scaled = kept * np.divide(lowered, peak, out=np.ones_like(peak), where=peak > 0)
    colour = 1 / (WHITENING * (peak - lowered) + 1)
    return encode_srgb(np.clip(lowered + colour * (scaled - lowered), 0, 1))


def _classic(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.minimum(1.2 * np.clip(rgb, 0, 1), 1) ** 1.2)


def _none(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(rgb, 0, 1)


TONE_MAPS: Mapping[str, Callable[[NDArray[np.float64]], NDArray[np.float64]]] = MappingProxyType(
    {"srgb": _srgb, "neutral": _neutral, "filmic": _filmic, "classic": _classic, "none": _none}
)
"""By name."""


def tone_map(rgb: ArrayLike, name: str = "srgb") -> NDArray[np.float64]:
    """(..., 3) linear radiance to display values from 0 to 1; InputError for a tone map that has no name here."""
    if name not in TONE_MAPS:
        raise InputError(f"film.tone_map: expected one of {', '.join(TONE_MAPS)}, got {name!r}", "film.tone_map")
    return TONE_MAPS[name](np.asarray(rgb, dtype=np.float64))
