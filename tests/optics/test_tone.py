"""Tone maps: exact where a standard says so, monotone, and true to the hue where they promise it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.observer import LUMINANCE
from culet.optics.tone import FILMIC_WHITE, TONE_MAPS, encode_srgb, filmic_curve, tone_map
from optics.colours import SPECTRAL, turned


def decoded(display: NDArray[np.float64]) -> NDArray[np.float64]:
    """IEC 61966-2-1's inverse: linear again."""
    return np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)


def grey(luminance: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.repeat(luminance[:, None], 3, axis=1)


def fire() -> NDArray[np.float64]:
    """Saturated colours over four and a half decades of radiance."""
    random = np.random.default_rng(1)
    return np.asarray(10 ** random.uniform(-3, 1.5, (20_000, 1)) * random.dirichlet((0.3, 0.3, 0.3), 20_000))


@pytest.mark.parametrize("name", TONE_MAPS)
def test_black_is_black_white_is_white_and_between_it_climbs(name: str) -> None:
    radiance = np.concatenate([[0], np.geomspace(1e-6, 100, 5000)])
    shown = tone_map(grey(radiance), name)
    assert shown[0].tolist() == [0, 0, 0]
    white = {"srgb": 1, "filmic": FILMIC_WHITE, "classic": 1 / 1.2, "none": 1, "neutral": np.inf}[name]
    assert shown[-1].tolist() == pytest.approx([1, 1, 1], abs=1e-15 if np.isfinite(white) else 2e-4)
    assert np.diff(shown, axis=0).min() > -1e-15  # next to white the last digit wavers
    below = radiance < white
    assert (np.diff(shown[below & (radiance < 0.99 * white)], axis=0) > 0).all()
    if np.isfinite(white):
        assert tone_map(grey(np.array([white])), name) == pytest.approx(1, abs=1e-15)
    assert np.ptp(shown, axis=1).max() < 1e-12  # grey stays grey


def test_srgb_is_the_standards() -> None:
    """IEC 61966-2-1: 12.92 below .0031308, 1.055 x^(1/2.4) - .055 above; middle grey .18 is .461356."""
    assert encode_srgb([0, 0.001, 0.0031308, 0.18, 0.5, 1]) == pytest.approx(
        [0, 0.01292, 0.04044994, 0.4613561, 0.7353570, 1], abs=5e-8
    )
    x = np.linspace(0, 1, 1001)
    assert decoded(encode_srgb(x)) == pytest.approx(x, abs=1e-7)  # the standard's two pieces miss each other by 3e-8


def test_classic_is_the_reports() -> None:
    assert tone_map([0.1, 0.5, 0.9], "classic") == pytest.approx([0.12**1.2, 0.6**1.2, 1], rel=1e-14, abs=0)


def test_neutral_leaves_colours_below_four_fifths_and_leads_brighter_ones_towards_white() -> None:
    """By hand: a peak of 1 becomes 1 - 0.04 / 0.4 = 0.9, one of 2.4 becomes 1 - 0.04 / 1.8 = 0.977778; 1 / (0.15 x the
    difference + 1) of the colour stays."""
    below = 0.8 * fire() / fire().max(axis=1, keepdims=True)
    assert tone_map(below, "neutral") == pytest.approx(tone_map(below), abs=1e-15)
    assert decoded(tone_map([1, 1, 1], "neutral")) == pytest.approx(0.9, abs=1e-7)
    kept = 1 / (0.15 * (2.4 - 0.9777778) + 1)
    assert decoded(tone_map([2.4, 0, 0], "neutral")) == pytest.approx(
        [0.9777778, 0.9777778 * (1 - kept), 0.9777778 * (1 - kept)], abs=1e-6
    )


def test_filmic_is_hables_curve() -> None:
    """Computed by hand from filmicworlds.com's constants: .18 becomes .128338, 1 becomes .492919, 5.6 is white."""
    assert filmic_curve([0, 0.18, 1, 5.6, 1000]) == pytest.approx([0, 0.128338, 0.492919, 1, 1], abs=5e-7)


def test_filmic_keeps_the_hue_and_luminance_of_bright_fire() -> None:
    """Hue turns by 1e-11 degrees, where the same curve on each component turns it by up to 53."""
    colours = fire()
    shown = decoded(tone_map(colours, "filmic"))
    coloured = np.ptp(shown, axis=1) > 1e-3  # of white no hue can be told
    assert coloured.mean() > 0.8
    assert turned(colours, shown)[coloured].max() < 1e-9
    assert turned(colours, filmic_curve(colours))[coloured].max() > 30
    assert shown @ LUMINANCE == pytest.approx(filmic_curve(colours @ LUMINANCE), abs=1e-14)  # measured 7e-16


def test_filmic_brings_spectral_colours_into_the_gamut_by_their_hue() -> None:
    shown = decoded(tone_map(SPECTRAL, "filmic"))
    assert shown.min() < 1e-15
    coloured = np.ptp(shown, axis=1) > 1e-3
    assert turned(SPECTRAL, shown)[coloured].max() < 1e-9  # measured 3e-14


def test_filmic_gives_up_saturation_only_where_the_screen_ends() -> None:
    """Ratios of components stay until one would be above 1."""
    dim = np.array([0.8, 0.1, 0.05])
    assert decoded(tone_map(dim, "filmic")) / dim == pytest.approx(
        [filmic_curve(dim @ LUMINANCE) / (dim @ LUMINANCE)] * 3, rel=1e-6
    )
    bright = decoded(tone_map(10 * dim, "filmic"))
    assert bright.max() == 1
    assert bright.min() > 0.05


@pytest.mark.parametrize("name", TONE_MAPS)
def test_whatever_comes_is_shown_between_0_and_1(name: str) -> None:
    wild = np.concatenate(
        [np.random.default_rng(2).normal(0, 10, (1000, 3)), [[1e300, 0, 0], [0, 0, 1e-300], [-1, 2, 1]]]
    )
    shown = tone_map(wild, name)
    assert np.isfinite(shown).all()
    assert shown.min() >= 0
    assert shown.max() <= 1


def test_an_unknown_tone_map_is_refused_with_the_known_ones() -> None:
    with pytest.raises(
        InputError, match=r"film\.tone_map: expected one of srgb, neutral, filmic, classic, none, got 'aces'"
    ):
        tone_map([0, 0, 0], "aces")
