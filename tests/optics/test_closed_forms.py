"""The closed forms that the pictures are judged by, against published and independently computed numbers."""

from __future__ import annotations

import math

import pytest

from optics.closed_forms import DIAMOND, deviation, fresnel, minimum_deviation, slab


def test_glass_reflects_four_hundredths_at_normal_incidence() -> None:
    assert fresnel(0, 1, 1.5) == pytest.approx(0.04, abs=1e-15)


@pytest.mark.parametrize(
    ("degrees", "n_i", "n_t", "r_p", "r_s"),
    [
        (45, 1, 1.5, 0.09201336304552442, 0.3033370452904235),
        (10, 1.5, 1, 0.19046797197779405, 0.20949431963852014),
    ],
)
def test_glass_reflects_as_hyperphysics_says(degrees: float, n_i: float, n_t: float, r_p: float, r_s: float) -> None:
    """Amplitudes of http://hyperphysics.phy-astr.gsu.edu/hbase/phyopt/freseq.html, as in Mitsuba's test_fresnel.py."""
    assert fresnel(math.sin(math.radians(degrees)), n_i, n_t) == pytest.approx((r_p**2 + r_s**2) / 2, abs=1e-15)


def test_diamond_reflects_as_published() -> None:
    """17.2 % at normal incidence, total reflection above 24.43 degrees, Brewster's angle 67.53 degrees."""
    assert fresnel(0, 1, DIAMOND) == pytest.approx(0.172038, abs=5e-7)
    assert math.degrees(math.asin(1 / DIAMOND)) == pytest.approx(24.43, abs=0.005)
    assert math.degrees(math.atan(DIAMOND)) == pytest.approx(67.53, abs=0.005)
    assert fresnel(math.sin(math.radians(24.44)), DIAMOND, 1) == 1
    assert fresnel(math.sin(math.radians(24.42)), DIAMOND, 1) < 0.9


def test_a_diamond_plate_passes_seven_tenths() -> None:
    """T = (1-R)/(1+R), R_s = 2R/(1+R); and with exp(-1/2) left after each passage."""
    reflectance = fresnel(0, 1, DIAMOND)
    assert slab(reflectance) == pytest.approx((0.706429, 0.293571), abs=5e-7)
    assert slab(reflectance, math.exp(-0.5)) == pytest.approx((0.420366, 0.215902), abs=5e-7)


@pytest.mark.parametrize(("apex", "expected"), [(20, 29.643), (30, 47.466), (40, 71.549)])
def test_the_symmetric_passage_through_a_prism_deviates_least(apex: float, expected: float) -> None:
    a = math.radians(apex)
    least = minimum_deviation(DIAMOND, a)
    assert math.degrees(least) == pytest.approx(expected, abs=5e-4)
    symmetric = (least + a) / 2
    assert deviation(DIAMOND, a, symmetric) == pytest.approx(least, abs=1e-12)
    assert deviation(DIAMOND, a, symmetric + 0.05) > least
    assert deviation(DIAMOND, a, symmetric - 0.05) > least
