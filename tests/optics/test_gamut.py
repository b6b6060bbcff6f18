"""Colours that no screen can show, made to fit."""

from __future__ import annotations

import numpy as np
import pytest

from culet.errors import InputError
from culet.optics.bands import bands
from culet.optics.gamut import GAMUT_METHODS, clip, desaturate, into_gamut
from culet.optics.observer import LUMINANCE
from optics.colours import SPECTRAL, turned


def test_desaturation_keeps_hue_and_luminance_of_spectral_colours() -> None:
    """Measured 3e-14 degrees and 2e-16; clipping turns the hue by up to 27 degrees and adds light."""
    shown = desaturate(SPECTRAL)
    assert shown.min() == 0
    assert turned(SPECTRAL, shown).max() < 1e-12
    assert np.abs(shown @ LUMINANCE - SPECTRAL @ LUMINANCE).max() < 1e-14
    assert turned(SPECTRAL, clip(SPECTRAL)).max() > 10
    assert (clip(SPECTRAL) @ LUMINANCE > SPECTRAL @ LUMINANCE).all()


def test_desaturation_goes_only_as_far_as_it_must() -> None:
    """One component ends at 0 exactly, or at the ceiling."""
    assert (desaturate(SPECTRAL).min(axis=-1) < 1e-15).all()
    bright = np.array([0.1, 0.2, 4.0])
    assert desaturate(bright, ceiling=1).max() == 1
    assert desaturate(bright, ceiling=1) @ LUMINANCE == pytest.approx(bright @ LUMINANCE, rel=1e-14, abs=0)
    assert turned(bright, desaturate(bright, ceiling=1)) < 1e-12


def test_colours_inside_are_left_alone() -> None:
    inside = np.random.default_rng(3).uniform(0, 5, (1000, 3))
    for method in GAMUT_METHODS.values():
        assert np.abs(method(inside) - inside).max() < 1e-14


@pytest.mark.parametrize("colour", [(0, 0, 0), (-1, 0, 0), (-1, -1, -1), (1, -5, 1)])
def test_no_light_is_black(colour: tuple[float, float, float]) -> None:
    assert desaturate(np.array(colour, dtype=np.float64)).tolist() == [0, 0, 0]


def test_more_light_than_white_is_white() -> None:
    assert desaturate(np.array([5.0, 4, 9]), ceiling=1).tolist() == [1, 1, 1]
    assert clip(np.array([5.0, 0.5, -9]), ceiling=1).tolist() == [1, 0.5, 0]


@pytest.mark.parametrize("method", GAMUT_METHODS)
def test_every_method_ends_inside(method: str) -> None:
    wild = np.random.default_rng(5).normal(0, 10, (2, 500, 3))
    assert into_gamut(wild, method).min() == 0
    assert into_gamut(wild, method).shape == wild.shape
    few = bands(4).weights
    assert into_gamut(few, method).min() == 0


def test_an_unknown_method_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="gamut: expected one of clip, desaturate, got 'squash'"):
        into_gamut(SPECTRAL, "squash")
