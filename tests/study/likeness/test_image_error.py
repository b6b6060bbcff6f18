"""Errors of pictures whose errors are known."""

from __future__ import annotations

import numpy as np
import pytest

from culet.scene.film import Film
from culet.study.likeness.image_error import (
    as_shown,
    colour_difference,
    structural_similarity,
)
from culet.study.likeness.radiance_error import enlarged, non_finite, radiance_error

GREY = np.full((8, 12, 3), 0.2)


def test_a_uniform_offset_is_rmse_maximum_and_bias() -> None:
    assert radiance_error(GREY - 0.05, GREY) == pytest.approx({"rmse": 0.05, "max": 0.05, "bias": -0.05})


def test_one_wrong_number_is_spread_by_the_mean_square() -> None:
    image = GREY.copy()
    image[3, 4, 1] += 0.6
    found = radiance_error(image, GREY)
    assert found["rmse"] == pytest.approx(0.6 / np.sqrt(GREY.size))
    assert found["max"] == pytest.approx(0.6)


def test_numbers_that_are_not_finite_are_counted_and_not_averaged() -> None:
    image = GREY.copy()
    image[0, 0] = np.nan, np.inf, 0.2
    assert non_finite(image) == 2
    assert radiance_error(image, GREY)["max"] == 0


def test_a_just_noticeable_grey_step_is_about_one_ciede2000() -> None:
    """L* of 50 and of 51 differ by 1, which is 1 / S_L = 1.000 in CIEDE2000 at L* near 50 (Sharma et al., 2005)."""
    luminance = [((lightness + 16) / 116) ** 3 for lightness in (50.0, 51.0)]
    dark, bright = (np.full((4, 4, 3), y) for y in luminance)
    assert colour_difference(bright, dark, Film()) == pytest.approx(1.0, abs=5e-3)  # measured 1.0000
    assert colour_difference(dark, dark, Film()) == 0


def test_what_is_shown_is_within_the_screen() -> None:
    shown = as_shown(np.array([[[-0.2, 0.5, 9.0], [np.nan, 0.0, 1.0]]]), Film())
    assert shown.min() >= 0
    assert shown.max() <= 1


def test_a_ramp_is_enlarged_to_the_same_ramp() -> None:
    small = np.repeat(np.linspace(0.125, 0.875, 4)[None, :, None], 3, axis=2).repeat(2, axis=0)
    large = enlarged(small, 4, 8)
    assert large[0, 1:-1, 0] == pytest.approx(np.linspace(0.0625, 0.9375, 8)[1:-1])
    assert large[0, [0, -1], 0] == pytest.approx([0.125, 0.875])  # beyond the outer centres there is nothing to mix
    upright = enlarged(small.transpose(1, 0, 2), 8, 4)
    assert upright == pytest.approx(large.transpose(1, 0, 2))
    assert enlarged(small, 2, 4) is small


def test_equal_frames_are_wholly_alike_and_noise_is_less() -> None:
    frame = np.tile(np.arange(0, 240, 10, dtype=np.uint8)[None, :, None], (24, 1, 3))
    noise = np.random.default_rng(1).integers(-20, 20, frame.shape)
    assert structural_similarity(frame, frame) == 1
    assert 0.1 < structural_similarity(np.clip(frame + noise, 0, 255).astype(np.uint8), frame) < 0.9
