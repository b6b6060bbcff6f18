"""The observer's table against published sums, and sRGB against its standard."""

from __future__ import annotations

import numpy as np
import pytest

from culet.errors import InputError
from culet.optics.observer import (
    LUMINANCE,
    RGB_TO_XYZ,
    XYZ_TO_RGB,
    colour_matching,
    colour_matching_table,
    linear_srgb,
)


def test_the_table_has_the_sums_of_the_standard() -> None:
    """CIE 018:2019 at 1 nm: 106.865469, 106.856895, 106.892251; every fifth row times 5 departs by 1e-3 at most."""
    table = colour_matching_table()
    assert table[:, 0].tolist() == list(range(360, 831, 5))
    assert table[:, 1:].sum(axis=0) * 5 == pytest.approx([106.8655, 106.8569, 106.8923], abs=2e-3)


def test_equal_energy_has_equal_coordinates() -> None:
    """CIE 15: x = y = z = 1/3 by construction; the table's rounding leaves 7e-5."""
    total = colour_matching_table()[:, 1:].sum(axis=0)
    assert total / total.sum() == pytest.approx([1 / 3] * 3, abs=1e-4)


def test_the_eye_is_most_sensitive_to_555_nm() -> None:
    table = colour_matching_table()
    assert table[np.argmax(table[:, 2]), 0] == 555
    assert colour_matching(555)[1] == 1
    # CIE 15, table of the 2 degree observer
    assert colour_matching([450, 600]) == pytest.approx(
        np.array([[0.3362, 0.0380, 1.77211], [1.0622, 0.6310, 0.0008]]), abs=1e-12
    )


def test_between_the_rows_it_is_linear() -> None:
    assert colour_matching(552.5) == pytest.approx((colour_matching(550) + colour_matching(555)) / 2, rel=1e-14, abs=0)


def test_the_matrix_is_that_of_iec_61966_2_1() -> None:
    """Printed with four decimals; the exact one departs by 4e-4, since the printed one inverts a rounded one."""
    printed = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
    assert pytest.approx(np.array(printed), abs=5e-4) == XYZ_TO_RGB
    printed = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    assert pytest.approx(np.array(printed), abs=5.1e-5) == RGB_TO_XYZ
    assert pytest.approx([0.2126, 0.7152, 0.0722], abs=5e-5) == LUMINANCE


def test_white_is_d65() -> None:
    white = RGB_TO_XYZ @ (1, 1, 1)
    assert white[:2] / white.sum() == pytest.approx([0.3127, 0.3290], abs=1e-15)
    assert white[1] == pytest.approx(1, abs=1e-15)


def test_spectral_colours_have_their_names() -> None:
    """Bluish at 450, greenish at 550, reddish at 620 nm; all outside the gamut."""
    for nanometres, strongest in ((450, 2), (550, 1), (620, 0)):
        colour = linear_srgb(nanometres)
        assert np.argmax(colour) == strongest
        assert colour.min() < 0


@pytest.mark.parametrize("outside", [359.9, 830.1, float("nan")])
def test_what_no_eye_sees_is_refused(outside: float) -> None:
    with pytest.raises(InputError, match="CIE 1931 observer: expected wavelengths from 360 to 830 nm"):
        colour_matching([500, outside])
