"""Ruby, sapphire and emerald have their colour, by spectrum and by three coefficients."""

from __future__ import annotations

import colorsys
import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.absorption import LEAST_TRANSMITTANCE, MATCHED_PATH_MM, AbsorptionSpectrum, GaussianBand
from culet.optics.bands import bands
from culet.optics.gamut import desaturate
from culet.optics.materials import MATERIALS
from culet.optics.tone import tone_map

COLOURED = ("ruby", "sapphire", "emerald")


def after(name: str, path_mm: float) -> NDArray[np.float64]:
    """Linear sRGB of white light, by the spectrum."""
    absorption = MATERIALS[name].absorption
    assert absorption is not None
    return absorption.colour_after(path_mm)


@pytest.mark.parametrize(("name", "low", "high"), [("ruby", 330, 360), ("sapphire", 225, 250), ("emerald", 130, 165)])
@pytest.mark.parametrize("path_mm", [3, 5, 8, 12])
def test_a_few_millimetres_have_the_stones_hue(name: str, low: float, high: float, path_mm: float) -> None:
    """HSV hue of the sRGB that is shown, degrees; measured from 343 to 351, 229 to 241 and 134 to 156."""
    red, green, blue = tone_map(desaturate(after(name, path_mm)), "srgb")
    hue, saturation, _ = colorsys.rgb_to_hsv(red, green, blue)
    assert low < 360 * hue < high
    assert saturation > 0.2  # measured 0.25 at least


@pytest.mark.parametrize("name", COLOURED)
def test_longer_paths_are_darker_and_none_shines(name: str) -> None:
    luminance = [float(after(name, path) @ (0.2126, 0.7152, 0.0722)) for path in (0, 1, 2, 5, 10, 20)]
    assert luminance[0] == pytest.approx(1, abs=1e-4)
    assert all(b < a for a, b in itertools.pairwise(luminance))
    assert (MATERIALS[name].absorption_per_mm(np.arange(380, 781)) >= 0).all()


@pytest.mark.parametrize(("name", "shorter"), [("ruby", 0.12), ("sapphire", 0.05), ("emerald", 0.05)])
def test_three_coefficients_leave_the_same_colour_at_the_matched_path(name: str, shorter: float) -> None:
    """And near it a similar one: at 2 mm within .119, .009 and .043, at 10 mm within .072, .028 and .073. Ruby's bands
    are the highest: its red keeps .45 after 2 mm and .24 after 5 mm, which is far from one exponential."""
    coefficients = np.array(MATERIALS[name].absorption_rgb_per_mm())
    matched = np.clip(after(name, MATCHED_PATH_MM), LEAST_TRANSMITTANCE, 1)  # ruby's green is out of the gamut by 0.008
    assert np.exp(-coefficients * MATCHED_PATH_MM) == pytest.approx(matched, abs=1e-12)
    assert np.exp(-coefficients * 2) == pytest.approx(after(name, 2), abs=shorter)
    assert np.exp(-coefficients * 10) == pytest.approx(after(name, 10), abs=0.08)


@pytest.mark.parametrize("name", COLOURED)
@pytest.mark.parametrize("path_mm", [2, 5, 10])
def test_sixteen_bands_see_the_colour_of_three_hundred(name: str, path_mm: float) -> None:
    few = bands(16)
    seen = np.exp(-path_mm * MATERIALS[name].absorption_per_mm(few.wavelength)) @ few.weights
    assert seen == pytest.approx(after(name, path_mm), abs=1e-2)  # measured 5.4e-3, the blue of sapphire


def test_a_band_is_half_as_high_at_half_its_width() -> None:
    band = GaussianBand(500, 4000, 0.3)
    heights = band.per_mm(1e7 / (1e7 / 500 + np.array([-2000, 0, 2000])))
    assert heights == pytest.approx([0.15, 0.3, 0.15], rel=1e-12, abs=0)


def test_bands_add_up_and_beer_and_lambert_hold() -> None:
    one, two = GaussianBand(450, 2000, 0.2), GaussianBand(600, 2000, 0.1)
    both, nm = AbsorptionSpectrum((one, two), ""), np.array([450.0, 520.0, 600.0])
    assert both.per_mm(nm) == pytest.approx(one.per_mm(nm) + two.per_mm(nm), rel=1e-14, abs=0)  # measured 0
    grey = AbsorptionSpectrum((GaussianBand(550, 1e9, 0.25),), "")
    assert grey.colour_after(8) == pytest.approx([np.exp(-2)] * 3, rel=1e-9)
    assert grey.rgb_per_mm() == pytest.approx([0.25] * 3, rel=1e-9)


def test_a_colour_outside_the_gamut_has_finite_coefficients() -> None:
    """Light of 500 nm alone has no red to match: the channel keeps a thousandth of it instead."""
    only_500 = AbsorptionSpectrum((GaussianBand(400, 4000, 50), GaussianBand(650, 4000, 50)), "")
    assert only_500.colour_after(MATCHED_PATH_MM)[0] < 0
    assert only_500.rgb_per_mm()[0] == pytest.approx(np.log(1000) / MATCHED_PATH_MM)
    assert min(only_500.rgb_per_mm()) >= 0


def test_a_channel_that_gains_absorbs_nothing() -> None:
    """Blue-green counts against red: light without it is redder than white."""
    without_500 = AbsorptionSpectrum((GaussianBand(500, 1500, 1),), "")
    assert without_500.colour_after(MATCHED_PATH_MM)[0] > 1.1
    assert without_500.rgb_per_mm()[0] == 0


def test_a_colourless_stone_absorbs_nothing() -> None:
    assert MATERIALS["diamond"].absorption_per_mm([[400, 500], [600, 700]]).tolist() == [[0, 0], [0, 0]]
    assert MATERIALS["diamond"].absorption_rgb_per_mm() == (0, 0, 0)
    assert {name for name, m in MATERIALS.items() if m.absorption is not None} == set(COLOURED)


def test_absorption_is_not_extrapolated() -> None:
    with pytest.raises(InputError, match="absorption: expected wavelengths from 380 to 780 nm, got 1000 nm"):
        MATERIALS["ruby"].absorption_per_mm([500, 1000])
