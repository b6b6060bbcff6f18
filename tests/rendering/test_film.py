"""Tone maps: from linear radiance to the bytes that a screen shows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.rendering.renderer import Renderer
from culet.scene.legacy import LEGACY_DEFAULT, legacy
from pictures import compared
from rendering.views import BARE, Array, radiance, take

SIZE = 640, 360


def srgb(x: Array) -> Array:
    """IEC 61966-2-1, from linear to encoded."""
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def classic(x: Array) -> Array:
    """The report's: times 1.2, to the power 1.2."""
    return (1.2 * x) ** 1.2


def neutral(x: Array) -> Array:
    """Khronos' PBR Neutral without its offset, per pixel as its reference implementation has it."""
    peak = x.max(axis=-1, keepdims=True)
    lowered = 1 - 0.2**2 / (np.maximum(peak, 0.8) + 0.2 - 0.8)
    white = 1 - 1 / (0.15 * (peak - lowered) + 1)
    compressed = (1 - white) * x * lowered / np.maximum(peak, 1e-9) + white * lowered
    return srgb(np.where(peak > 0.8, compressed, x))


FORMULAS: dict[str, Callable[[Array], Array]] = {
    "srgb": srgb,
    "neutral": neutral,
    "classic": classic,
    "none": np.asarray,
}


def to_bytes(encoded: Array) -> NDArray[np.int64]:
    return np.rint(255 * np.clip(encoded, 0, 1)).astype(np.int64)


def ramp(renderer: Renderer, tone_map: str, exposure: float, brightest: float) -> tuple[Array, NDArray[np.int64]]:
    """All radiances up to that, and what is shown of them: a vertical gradient in each channel, finely graded."""
    scene = legacy(
        {
            **BARE,
            "stones": [],
            "environment": {"kind": "gradient", "bottom": [0, 0, 0], "top": [brightest, brightest / 3, brightest / 30]},
            "camera": {"position": [0, 0, 0], "target": [0, 0, -1], "fov_degrees": 170},
            "film": {"tone_map": tone_map, "exposure": exposure},
        }
    )
    picture = take(renderer, scene, size=SIZE)
    return radiance(picture), picture.rgb().astype(np.int64)


@pytest.mark.parametrize("exposure", [1, 0.25, 3])
@pytest.mark.parametrize("tone_map", FORMULAS)
def test_bytes_are_those_of_the_formula(renderer: Renderer, tone_map: str, exposure: float) -> None:
    """Never more than one level off, and that where the formula is at a half."""
    linear, shown = ramp(renderer, tone_map, exposure, 1.2 / exposure)
    expected = to_bytes(FORMULAS[tone_map](exposure * linear))
    assert len(np.unique(expected)) == 256 if tone_map != "neutral" else expected.max() > 240
    with compared(np.atleast_2d(shown), np.atleast_2d(expected)):
        assert abs(shown - expected).max() <= 1
        assert (shown != expected).mean() < 2e-5  # measured 5.8e-6


@pytest.mark.parametrize("tone_map", ["srgb", "classic", "none"])
def test_what_is_too_bright_is_white_and_what_is_dark_is_black(renderer: Renderer, tone_map: str) -> None:
    linear, shown = ramp(renderer, tone_map, 1e6, 1e6)
    assert (shown[linear > 1e-4] == 255).all()
    _, shown = ramp(renderer, tone_map, 1e-6, 1)
    assert (shown == 0).all()


def test_the_mean_of_the_samples_is_shown_not_their_sum(renderer: Renderer) -> None:
    scene = legacy({**BARE, "stones": [], "environment": {"kind": "constant", "radiance": [0.2, 0.4, 0.8]}})
    for samples in (1, 5):
        assert take(renderer, scene, size=(5, 3), samples=samples).rgb()[1, 2].tolist() == [124, 170, 231]


@pytest.mark.parametrize("pixels", [1, 15, 16, 17, 33])
def test_every_pixel_of_an_odd_number_is_shown(renderer: Renderer, pixels: int) -> None:
    """Blocks of 16 pixels: the last one may be short, and nothing is written beyond it."""
    scene = legacy({**BARE, "stones": [], "environment": {"kind": "constant"}})
    assert (take(renderer, scene, size=(pixels, 1)).rgb() == 255).all()


def test_double_precision_is_shown_the_same(renderer: Renderer, exact: Renderer) -> None:
    single, double = (take(used, LEGACY_DEFAULT).rgb().astype(int) for used in (renderer, exact))
    assert (abs(single - double).max(axis=-1) > 1).mean() < 0.002  # measured 0 of 5184
