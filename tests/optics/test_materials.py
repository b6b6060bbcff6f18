"""The named materials against the numbers of their sources, and what a scene may ask for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.errors import InputError, SceneError
from culet.optics.dispersion import channel_indices
from culet.optics.materials import CLASSIC_INDICES, MATERIALS, PETER_1923, material_of
from culet.optics.wavelengths import LINE_B, LINE_C, LINE_D, LINE_F, LINE_G, RGB_NANOMETRES
from culet.scene.stone import IndexMaterial, SellmeierMaterial

CHECK_VALUES = {
    # at 450, 550, 650 nm and the d line; n_F - n_C; computed once from the published coefficients by another program
    "diamond": (2.44536, 2.42295, 2.41050, 2.41749, 0.02563),
    "diamond-turri": (2.44306, 2.42103, 2.40870, 2.41563, 0.02531),
    "moissanite": (2.71820, 2.66145, 2.63093, 2.64799, 0.06349),
    "cubic-zirconia": (2.19664, 2.16611, 2.14939, 2.15877, 0.03455),
    "sapphire": (1.77935, 1.77045, 1.76515, 1.76817, 0.01062),
    "ruby": (1.77935, 1.77045, 1.76515, 1.76817, 0.01062),
    "emerald": (1.58790, 1.58092, 1.57691, 1.57917, 0.00816),
    "spinel": (1.72873, 1.71874, 1.71288, 1.71621, 0.01181),
    "yag": (1.84973, 1.83617, 1.82837, 1.83279, 0.01584),
    "quartz": (1.55248, 1.54595, 1.54205, 1.54428, 0.00781),
    "strontium-titanate": (2.54131, 2.43182, 2.38119, 2.40892, 0.11081),
    "rutile": (2.81257, 2.64794, 2.57417, 2.61426, 0.16358),
    "bk7": (1.52532, 1.51852, 1.51452, 1.51680, 0.00805),
}
HALF_A_DIGIT = 5.1e-6
"""Of five decimals, and a little for the rounding itself."""

RANGES_NM = {
    "diamond": (226, 760),
    "diamond-turri": (300, 1650),
    "moissanite": (435.8, 2325),
    "cubic-zirconia": (361, 5135),
    "sapphire": (200, 5000),
    "ruby": (200, 5000),
    "emerald": (400, 700),
    "spinel": (350, 5500),
    "yag": (400, 5000),
    "quartz": (198, 2053.1),
    "strontium-titanate": (430, 3800),
    "rutile": (430, 1530),
    "bk7": (300, 2500),
    "classic": (435.8, 656.3),
}

NAMES = pytest.mark.parametrize("name", RANGES_NM)


@pytest.mark.parametrize("name", CHECK_VALUES)
def test_indices_are_those_of_the_source(name: str) -> None:
    *indices, dispersion = CHECK_VALUES[name]
    material = MATERIALS[name]
    assert material.index((450, 550, 650, LINE_D)) == pytest.approx(indices, abs=HALF_A_DIGIT)
    n_f, n_c = material.index((LINE_F, LINE_C))
    assert n_f - n_c == pytest.approx(dispersion, abs=HALF_A_DIGIT)


def test_every_material_has_values_to_check_and_a_range() -> None:
    assert set(MATERIALS) == set(CHECK_VALUES) | {"classic"} == set(RANGES_NM)
    assert {name: material.span_nm for name, material in MATERIALS.items()} == RANGES_NM
    assert all(material.source and material.summary and material.name == name for name, material in MATERIALS.items())


@pytest.mark.parametrize(
    ("name", "published", "tolerance"),
    [("diamond", 0.044, 5e-4), ("cubic-zirconia", 0.060, 5e-4), ("sapphire", 0.018, 5e-4), ("spinel", 0.020, 5e-4)],
)
def test_the_gemmologists_dispersion_is_that_of_their_tables(name: str, published: float, tolerance: float) -> None:
    """n(G) - n(B); measured .0444, .0604, .0181, .0202."""
    n_g, n_b = MATERIALS[name].index((LINE_G, LINE_B))
    assert n_g - n_b == pytest.approx(published, abs=tolerance)


def test_strontium_titanate_follows_the_table_it_was_fitted_to() -> None:
    """W. L. Bond (1965): departs by .0043, .0023, .0005, .0020."""
    bond = (2.5370, 2.4720, 2.4020, 2.3630)
    assert MATERIALS["strontium-titanate"].index((450, 500, 600, 700)) == pytest.approx(bond, abs=5e-3)


def test_other_laboratories_agree() -> None:
    """YAG: J. Hrabovsky et al., Opt. Mater. Express 11, 1218 (2021), .0006 apart; moissanite: S. Singh (1971), .0010
    apart; the two diamonds .0031 from 380 to 760 nm."""
    square = np.array([0.45, 0.55, 0.65]) ** 2
    hrabovsky = np.sqrt(1.882 + 1.404 * square / (square - 0.1338**2) - 0.0137 * square)
    assert MATERIALS["yag"].index((450, 550, 650)) == pytest.approx(hrabovsky, abs=8e-4)
    square = np.array([0.488, 0.55, 0.65]) ** 2
    singh = np.sqrt(1 + 5.5394 * square / (square - 0.026945))
    assert MATERIALS["moissanite"].index((488, 550, 650)) == pytest.approx(singh, abs=1.2e-3)
    visible = np.arange(380, 761)
    assert MATERIALS["diamond"].index(visible) == pytest.approx(MATERIALS["diamond-turri"].index(visible), abs=3.3e-3)


def test_emerald_is_marked_as_weakly_sourced() -> None:
    assert [name for name, m in MATERIALS.items() if m.confidence == "weak source"] == ["emerald"]
    assert MATERIALS["emerald"].index(LINE_D) == pytest.approx(1.58, abs=5e-3)  # GlobalSpec, emerald lasers: n_o = 1.58


def test_doubly_refracting_stones_say_that_their_ordinary_ray_is_meant() -> None:
    uniaxial = {name for name, m in MATERIALS.items() if m.ray == "ordinary ray"}
    assert uniaxial == {"moissanite", "sapphire", "ruby", "emerald", "quartz", "rutile"}


@NAMES
def test_violet_bends_most(name: str) -> None:
    material = MATERIALS[name]
    low, high = max(material.span_nm[0], 390), min(material.span_nm[1], 700)
    assert (np.diff(material.index(np.linspace(low, high, 500))) < 0).all()


@NAMES
def test_no_index_is_extrapolated(name: str) -> None:
    material = MATERIALS[name]
    low, high = material.span_nm
    assert material.index((low, high)).shape == (2,)
    for outside in (low * (1 - 1e-9), high * (1 + 1e-9), math.nan, math.inf, 0.0, -500.0):
        with pytest.raises(
            InputError, match=rf"^{name}: expected wavelengths from {low:g} to {high:g} nm, got .*clamp"
        ):
            material.index((low, outside))
    assert material.index((low / 2, 1.5 * high), clamp=True).tolist() == material.index((low, high)).tolist()
    with pytest.raises(InputError):
        material.index(math.nan, clamp=True)


def test_the_shape_of_the_wavelengths_is_kept() -> None:
    assert MATERIALS["diamond"].index(550).shape == ()
    assert MATERIALS["diamond"].index(np.full((2, 3), 550)).shape == (2, 3)


def test_three_indices_become_a_curve_through_them() -> None:
    """Between two lines Cauchy's formula, beyond them constant: never outside the given indices."""
    assert material_of("classic").index(RGB_NANOMETRES).tolist() == list(CLASSIC_INDICES)
    odd = material_of(IndexMaterial(ior=(3, 1, 3)))
    everywhere = odd.index(np.linspace(300, 900, 1000), clamp=True)
    assert everywhere.min() >= 1
    assert everywhere.max() == 3
    between = 1 / math.sqrt((1 / RGB_NANOMETRES[0] ** 2 + 1 / RGB_NANOMETRES[1] ** 2) / 2)
    assert odd.index(between) == pytest.approx(2, abs=1e-12)


@NAMES
def test_the_channels_have_the_indices_of_their_lines(name: str) -> None:
    assert channel_indices(name) == tuple(MATERIALS[name].index(RGB_NANOMETRES))


def test_a_scenes_own_formula_is_judged_at_every_wavelength() -> None:
    own = material_of(SellmeierMaterial(sellmeier=PETER_1923))
    assert own.index(LINE_D) == MATERIALS["diamond"].index(LINE_D)
    resonant = material_of(SellmeierMaterial(sellmeier=((1.0, 0.5),)))
    for at in (500, 400):
        with pytest.raises(SceneError, match=rf"expected an index from 1 to 10, got .* at {at} nm") as refusal:
            resonant.index((650, at))
        assert refusal.value.field == "stones.0.material.sellmeier"
    with pytest.raises(SceneError, match="an index from 1 to 10"):
        material_of(SellmeierMaterial(sellmeier=((1e308, 0.1), (1e308, 0.1)))).index(550)


def test_an_unknown_name_is_refused_with_the_known_ones() -> None:
    with pytest.raises(SceneError, match=r"expected one of diamond, .*, classic, got 'kryptonite'") as refusal:
        material_of("kryptonite")
    assert refusal.value.field == "stones.0.material"
