"""Bands: white stays white, colours are right, a few of them converge."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.errors import InputError
from culet.optics.bands import FEWEST, MOST, SPAN_NANOMETRES, bands
from culet.optics.materials_page import bias, largest_weight
from culet.optics.observer import colour_matching_table, linear_srgb

OFFSETS = (0.0, 0.123, 0.5, 0.877, 1.0)


@pytest.mark.parametrize("groups", range(1, 9))
def test_white_is_white_in_every_group(groups: int) -> None:
    for count in range(FEWEST, 65):
        for offset in OFFSETS:
            b = bands(count, offset, groups)
            for group in range(groups):
                taken = b.weights[b.group == group]
                assert taken.shape == (count, 3)
                assert np.abs(taken.sum(axis=0) - 1).max() < 1e-12  # measured 2e-15


def test_single_precision_keeps_white_to_a_millionth() -> None:
    """As a kernel sums them, one after the other; measured 5.4e-7."""
    for count in range(FEWEST, 65):
        for offset in OFFSETS:
            total = np.zeros(3, np.float32)
            for weight in bands(count, offset).weights.astype(np.float32):
                total += weight
            assert np.abs(total - 1).max() < 1e-6


def test_the_strata_are_equally_wide_and_dealt_in_turn() -> None:
    b = bands(5, 0.25, 3)
    assert b.wavelength[0] == 390 + 0.25 * 310 / 15
    assert np.diff(b.wavelength) == pytest.approx(310 / 15, rel=1e-12, abs=0)
    assert b.group.tolist() == [0, 1, 2] * 5


def test_a_group_is_spread_like_fewer_and_wider_strata() -> None:
    """So that what is known of `count` bands is known of each group."""
    many = bands(8, 0.4, 4)
    for group in range(4):
        one = bands(8, (group + 0.4) / 4)
        assert many.wavelength[many.group == group] == pytest.approx(one.wavelength, rel=1e-12, abs=0)
        assert many.weights[many.group == group] == pytest.approx(one.weights, abs=1e-12)


def test_hardly_anything_that_is_seen_lies_outside_the_strata() -> None:
    """Of the red .9963, of the green 1.0007 (the ends are negative), of the blue .9981."""
    everything = linear_srgb(colour_matching_table()[:, 0]).sum(axis=0) * 5
    low, high = SPAN_NANOMETRES
    inside = linear_srgb(np.linspace(low, high, 3101)[:-1] + 0.05).sum(axis=0) * 0.1
    assert inside / everything == pytest.approx([0.9963, 1.0007, 0.9981], abs=2e-4)


def test_from_four_on_no_weight_blows_up() -> None:
    """Over all offsets; measured 1.32, 1.19, 1.00, 0.82."""
    assert [largest_weight(count) for count in (4, 5, 6, 8)] == pytest.approx([1.32, 1.19, 1.00, 0.82], abs=0.005)
    assert all(largest_weight(count) <= largest_weight(FEWEST) for count in range(FEWEST, 65))


def test_the_primaries_are_their_own_colours() -> None:
    """White light cut to what is longer than 600 nm is red, 500 to 570 nm green, shorter than 480 nm blue."""
    b = bands(62)
    cuts = (b.wavelength > 600, (b.wavelength > 500) & (b.wavelength < 570), b.wavelength < 480)
    for strongest, cut in enumerate(cuts):
        colour = cut @ b.weights
        assert np.argmax(colour) == strongest
        assert (np.delete(colour, strongest) < 0.1 * colour[strongest]).all()  # measured 0.04 at most


def _ramp(wavelength: NDArray[np.float64]) -> NDArray[np.float64]:
    return (wavelength - 390) / 310


def _above_580(wavelength: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(wavelength > 580, 1.0, 0.0)


def test_a_few_bands_converge_over_offsets() -> None:
    """A single draw of 8 departs by up to .32 for an edge; the mean of 256 by .0011, its bias. Of 4 it is .028."""
    draws = [_above_580(b.wavelength) @ b.weights for b in (bands(8, offset) for offset in np.linspace(0, 1, 101))]
    truth = _above_580(bands(2048).wavelength) @ bands(2048).weights
    assert max(float(np.abs(draw - truth).max()) for draw in draws) > 0.1
    assert [bias(_above_580, count) for count in (4, 6, 8, 16)] == pytest.approx([0.028, 0.004, 0.001, 0], abs=1e-3)
    assert [bias(_ramp, count) for count in (4, 6, 8, 16)] == pytest.approx([0.0025, 0.0007, 0, 0], abs=1e-4)


def test_more_bands_come_nearer_to_the_spectrum() -> None:
    truth = _ramp(bands(2048).wavelength) @ bands(2048).weights
    errors = [
        float(np.abs(_ramp((b := bands(count)).wavelength) @ b.weights - truth).max()) for count in (4, 8, 16, 64)
    ]
    assert all(b < a for a, b in itertools.pairwise(errors))
    assert errors[-1] < 5e-4  # measured 2.6e-4


@pytest.mark.parametrize(
    ("count", "offset", "groups", "message"),
    [
        (3, 0.5, 1, "bands: expected at least 4 wavelengths in a group, got 3"),
        (8, 0.5, 0, "groups: expected at least 1, got 0"),
        (64, 0.5, MOST, f"expected at most {MOST}"),
        (8, -0.1, 1, "offset: expected from 0 to 1, got -0.1"),
        (8, 1.1, 1, "offset: expected from 0 to 1, got 1.1"),
        (8, float("nan"), 1, "offset: expected from 0 to 1, got nan"),
    ],
)
def test_what_cannot_be_sampled_is_refused(count: int, offset: float, groups: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        bands(count, offset, groups)


def test_bands_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        bands(8).weights[0, 0] = 1
