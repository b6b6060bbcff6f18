"""The chains of a picture: an index of refraction each, its absorption, and what it lights of each channel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.optics.bands import bands
from culet.optics.dispersion import channel_indices
from culet.optics.materials import material_of
from culet.rendering.opencl.device import Real
from culet.rendering.opencl.layout import constants, struct
from culet.scene.model import Scene
from culet.scene.stone import StoneSettings
from culet.stage import Stage

GROUPS = constants("features.cl")["SPECTRAL_GROUPS"]
"""Sets of wavelengths that neighbouring pixels take."""
GOLDEN = 0.6180339887498949
"""Fractional part of the golden ratio: multiples of it, modulo 1, fill the strata of the spectrum evenly."""

CHANNELS = 3
"""Bands of a picture that gives each channel an index, and samples no wavelengths."""
AUTO_BANDS = 6
"""Wavelengths of a sample where the scene leaves their number open: twice as dear as three indices. Four come as near
in three quarters of the time, but to no less than 0.006 of what is shown of a diamond's fire, and six to 0.004: few
wavelengths are biased (docs/reference/materials.md). Eight come no nearer than six in the same time."""


def disperses(scene: Scene) -> bool:
    """Whether a stone has another index for each channel."""
    return any(len(set(channel_indices(material))) > 1 for material in {stone.material for stone in scene.stones})


def band_count(scene: Scene) -> int:
    """Wavelengths of each of a picture's samples, but for what `first_sample` says of the first one."""
    match scene.optics.bands:
        case "auto":
            return AUTO_BANDS if scene.optics.estimator == "chain" and disperses(scene) else CHANNELS
        case count:
            return count


def first_sample(stage: Stage) -> Stage:
    """What the first sample of a picture shows: three indices, where the scene leaves the number of wavelengths open.

    It is there in half the time, it looks like the moving picture before it, and in the mean with the spectral samples
    that follow it is a sample among others: what it lacks of the spectrum goes as 1 / n, sooner than their noise does.
    So no picture is worse than the one before it.
    """
    scene = stage.scene
    if scene.optics.bands != "auto" or band_count(scene) == CHANNELS:
        return stage
    return stage.showing(scene.model_copy(update={"optics": scene.optics.model_copy(update={"bands": CHANNELS})}))


def bands_seen(scene: Scene, samples: int) -> int:
    """Wavelengths of the last one of so many samples."""
    return CHANNELS if scene.optics.bands == "auto" and samples <= 1 else band_count(scene)


def is_spectral(scene: Scene) -> bool:
    """Whether the picture samples wavelengths, rather than giving each channel one index."""
    return band_count(scene) > CHANNELS and scene.optics.estimator == "chain"


def absorption(scene: Scene, stone: StoneSettings) -> tuple[float, float, float]:
    """Of the red, green and blue channel, per R: what the scene asks for, and what the material has by itself."""
    own = material_of(stone.material).absorption_rgb_per_mm()
    red, green, blue = (
        asked + coefficient * scene.millimetres for asked, coefficient in zip(stone.absorption, own, strict=True)
    )
    return red, green, blue


def is_coloured(scene: Scene) -> bool:
    """Whether light is absorbed in a stone."""
    return any(any(absorption(scene, stone)) for stone in chains_of_stones(scene)[1])


def chains_of_stones(scene: Scene) -> tuple[list[int], list[StoneSettings]]:
    """For each stone of the scene the number of its set of chains, and for each set a stone that it is of: stones of
    one material, absorption and size share it."""
    kinds: dict[object, int] = {}
    sets: list[StoneSettings] = []
    numbers = []
    for stone in scene.stones:  # the scene's measure of millimetres is the same for all
        kind = stone.material, stone.absorption, stone.scale
        if kind not in kinds:
            kinds[kind] = len(sets)
            sets.append(stone)
        numbers.append(kinds[kind])
    return numbers, sets


def chain_table(
    scene: Scene, sample: int, real: Real, *, common: bool, wavelengths: Sequence[float] = ()
) -> NDArray[np.void]:
    """(S N,) one row a chain, N for each set of `chains_of_stones`. `common`: the channels share one index; else each
    has its own.

    A spectral scene has `bands` wavelengths for each of the GROUPS of pixels instead, which take the rows by turns;
    they move within their strata from sample to sample. Of `wavelengths` (nm) that are given in their place all groups
    take each, with equal shares of every channel. Absorption is per radius of the stone.
    """
    return np.concatenate(
        [_chains(scene, stone, sample, real, common, wavelengths) for stone in chains_of_stones(scene)[1]]
    )


def wavelengths_of(scene: Scene, sample: int) -> NDArray[np.float64]:
    """(N,) nm of the rows of a set of `chain_table`, of a spectral scene."""
    return bands(band_count(scene), offset=(0.5 + sample * GOLDEN) % 1, groups=GROUPS).wavelength


def _chains(
    scene: Scene, stone: StoneSettings, sample: int, real: Real, common: bool, wavelengths: Sequence[float]
) -> NDArray[np.void]:
    scale = stone.scale
    if wavelengths:
        repeated = np.repeat(np.array(wavelengths, dtype=float), GROUPS)
        return _spectral(scene, stone, repeated, np.full((len(repeated), 3), 1 / len(wavelengths)), real)
    if not is_spectral(scene):
        table = np.zeros(1 if common and scene.optics.estimator == "chain" else 3, struct("chain_t", real))
        table["eta"] = channel_indices(stone.material)[: len(table)]
        table["absorption"] = scale * np.array(absorption(scene, stone)[: len(table)])
        table["share"] = np.eye(3)[: len(table)]
        return table
    spectrum = bands(band_count(scene), offset=(0.5 + sample * GOLDEN) % 1, groups=GROUPS)
    return _spectral(scene, stone, spectrum.wavelength, spectrum.weights, real)


def _spectral(
    scene: Scene, stone: StoneSettings, wavelength: NDArray[np.float64], shares: NDArray[np.float64], real: Real
) -> NDArray[np.void]:
    material, scale = material_of(stone.material), stone.scale
    table = np.zeros(len(wavelength), struct("chain_t", real))
    table["eta"] = material.index(wavelength, clamp=True)
    own = material.absorption_per_mm(wavelength) * scene.millimetres
    table["absorption"] = scale * (own + asked_absorption(stone, wavelength))
    table["share"] = shares
    table["summed_share"] = abs(shares).sum(axis=1)
    return table


def asked_absorption(stone: StoneSettings, wavelength: NDArray[np.float64]) -> NDArray[np.float64]:
    """The scene's three coefficients over wavelength, per R: linear between the lines that stand for the channels."""
    red, green, blue = stone.absorption
    return np.interp(wavelength, (435.8, 546.1, 656.3), (blue, green, red))
