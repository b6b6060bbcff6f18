"""Indices of refraction against published tables."""

from __future__ import annotations

import math

import pytest

from culet.errors import SceneError
from culet.optics.dispersion import PETER_1923, channel_indices, sellmeier
from culet.scene.stone import IndexMaterial, SellmeierMaterial

BK7 = ((1.03961212, 0.00600069867**0.5), (0.231792344, 0.0200179144**0.5), (1.01046945, 103.560653**0.5))
"""SCHOTT's data sheet of N-BK7; it gives the squares of C."""


def test_diamond_has_the_index_and_abbe_number_of_refractiveindex_info() -> None:
    """n_d = 2.41748 (2.41749 by its own formula), V_d = 55.30."""
    n_d, n_f, n_c = (sellmeier(PETER_1923, line) for line in (587.5618, 486.1327, 656.2725))
    assert n_d == pytest.approx(2.41748, abs=1.5e-5)
    assert (n_d - 1) / (n_f - n_c) == pytest.approx(55.30, abs=5e-3)


def test_diamond_disperses_0_044_between_b_and_g() -> None:
    """The gemmologists' dispersion: n(430.8 nm) - n(686.7 nm) = 0.044."""
    assert sellmeier(PETER_1923, 430.8) - sellmeier(PETER_1923, 686.7) == pytest.approx(0.044, abs=5e-4)


def test_glass_has_the_indices_of_its_data_sheet() -> None:
    """n_d = 1.51680, Abbe number 64.17."""
    n_d, n_f, n_c = (sellmeier(BK7, line) for line in (587.5618, 486.1327, 656.2725))
    assert n_d == pytest.approx(1.51680, abs=5e-6)
    assert (n_d - 1) / (n_f - n_c) == pytest.approx(64.17, abs=5e-3)


def test_the_channels_are_the_lines_c_e_and_g() -> None:
    """656.3, 546.1 and 435.8 nm; the indices computed once by hand from Peter's formula."""
    assert channel_indices("diamond") == pytest.approx((2.40990, 2.42359, 2.44998), abs=5e-6)
    assert channel_indices("classic") == (1.7, 1.8, 1.9)
    assert channel_indices(IndexMaterial(ior=(1, 2, 3))) == (1, 2, 3)
    assert channel_indices(SellmeierMaterial(sellmeier=PETER_1923)) == channel_indices("diamond")


def test_a_formula_that_has_no_index_is_refused_with_its_wavelength() -> None:
    assert math.isnan(sellmeier(((-5.0, 0.1),), 589.3))
    for pairs in (((-5.0, 0.1),), ((1.0, 0.6563),), ((1e9, 0.1),), ((-0.5, 0.0),)):
        with pytest.raises(SceneError, match=r"an index from 1 to 10, got .* at 656\.3 nm") as refusal:
            channel_indices(SellmeierMaterial(sellmeier=pairs))
        assert refusal.value.field == "stones.0.material.sellmeier"
