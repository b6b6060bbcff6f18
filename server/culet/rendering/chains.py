"""The chains of a picture: an index of refraction each, its absorption, and what it lights of each channel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.optics.bands import bands
from culet.optics.dispersion import channel_indices
from culet.optics.materials import material_of
from culet.rendering.device import Real
from culet.rendering.layout import constants, struct
from culet.scene.model import Scene

GROUPS = constants("features.cl")["SPECTRAL_GROUPS"]
"""Sets of wavelengths that neighbouring pixels take."""
GOLDEN = 0.6180339887498949
"""Fractional part of the golden ratio: multiples of it, modulo 1, fill the strata of the spectrum evenly."""


def is_spectral(scene: Scene) -> bool:
    """Whether the picture samples wavelengths, rather than giving each channel one index."""
    return scene.optics.bands > 3 and scene.optics.estimator == "chain"


def absorption(scene: Scene) -> tuple[float, float, float]:
    """Of the red, green and blue channel, per R: what the scene asks for, and what the material has by itself."""
    stone = scene.stones[0]
    own = material_of(stone.material).absorption_rgb_per_mm()
    red, green, blue = (
        asked + coefficient * scene.millimetres for asked, coefficient in zip(stone.absorption, own, strict=True)
    )
    return red, green, blue


def is_coloured(scene: Scene) -> bool:
    """Whether light is absorbed in the stone."""
    return any(absorption(scene))


def chain_table(scene: Scene, sample: int, real: Real, *, common: bool) -> NDArray[np.void]:
    """(N,) one row a chain. `common`: the channels share one index; else each has its own.

    A spectral scene has `bands` wavelengths for each of the GROUPS of pixels instead, which take the rows by turns;
    they move within their strata from sample to sample.
    """
    if not is_spectral(scene):
        table = np.zeros(1 if common and scene.optics.estimator == "chain" else 3, struct("chain_t", real))
        table["eta"] = channel_indices(scene.stones[0].material)[: len(table)]
        table["absorption"] = absorption(scene)[: len(table)]
        table["share"] = np.eye(3)[: len(table)]
        return table
    stone = scene.stones[0]
    material = material_of(stone.material)
    spectrum = bands(scene.optics.bands, offset=(0.5 + sample * GOLDEN) % 1, groups=GROUPS)
    table = np.zeros(len(spectrum.wavelength), struct("chain_t", real))
    table["eta"] = material.index(spectrum.wavelength, clamp=True)
    table["absorption"] = material.absorption_per_mm(spectrum.wavelength) * scene.millimetres + _asked(
        scene, spectrum.wavelength
    )
    table["share"] = spectrum.weights
    table["summed_share"] = abs(spectrum.weights).sum(axis=1)
    return table


def _asked(scene: Scene, wavelength: NDArray[np.float64]) -> NDArray[np.float64]:
    """The scene's three coefficients over wavelength, per R: linear between the lines that stand for the channels."""
    red, green, blue = scene.stones[0].absorption
    return np.interp(wavelength, (435.8, 546.1, 656.3), (blue, green, red))
