"""What a picture says of its own error, against its distance from one of many more samples."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from culet.optics.gamut import into_gamut
from culet.optics.tone import tone_map
from culet.rendering.film.target import Target
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import preset
from culet.scene.film import Film
from culet.scene.legacy import LEGACY_DEFAULT, legacy
from rendering.views import BARE, UPRIGHT, Array, radiance, take

SCENES: dict[str, dict[str, Any]] = {
    "default": {},
    "matte floor": {"floor": {"kind": "matte"}},
    "mirrors": {"walls": {"kind": "mirror"}},
    "stone alone": BARE,
    "half-lit": {**BARE, "environment": {"kind": "half"}, "stones": [UPRIGHT]},
    "spectral": {"optics": {"bands": 8}},
    "polarised": {"optics": {"polarised": True}},
    "light box": {"environment": {"kind": "image"}},
    "roulette": {"optics": {"end": "roulette", "cutoff": 0.1}},
    "tent": {"sampling": {"filter": "tent"}},
    "ruby": {"stones": [{"material": "ruby"}], "optics": {"bands": 8}},
}


COUNTS = (2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 24, 28, 32, 48, 56, 64)
"""Samples; a doubling's first estimate and what becomes of it until the next."""


def as_shown(linear: Array, film: Film) -> Array:
    """0 (black) to 1 (white), by the formulas in double precision."""
    return np.clip(tone_map(into_gamut(film.exposure * linear, film.gamut), film.tone_map), 0, 1)


def ratios(picture: DevicePicture, counts: Sequence[int], converged: int) -> dict[str, dict[int, float]]:
    """Estimated over true error, of radiance and as shown, by samples; the truth is the same picture, refined much
    further."""
    estimates, images, film = {}, {}, picture.scene.film
    for n in (*counts, converged):
        for _ in picture.refine_until(Target(n), math.inf):
            pass
        estimates[n] = picture.error_estimate(), picture.shown_error()
        images[n] = radiance(picture), as_shown(radiance(picture), film)
    found = {}
    for number, name in enumerate(("radiance", "shown")):
        truth = images[converged][number]
        true = {n: math.sqrt(((images[n][number] - truth) ** 2).mean()) for n in counts}
        found[name] = {n: estimates[n][number] / true[n] for n in counts}
    return found


def beyond_a_factor_of_two(found: dict[str, dict[int, float]]) -> dict[tuple[str, int], float]:
    """Ratios by measure and samples."""
    for name, of_counts in found.items():
        print(f"{name}: {min(of_counts.values()):.2f} to {max(of_counts.values()):.2f}")
    return {(name, n): ratio for name, each in found.items() for n, ratio in each.items() if not 0.5 < ratio < 2}


@pytest.mark.parametrize("settings", SCENES.values(), ids=SCENES.keys())
def test_the_error_estimate_is_within_a_factor_of_two(renderer: Renderer, settings: dict[str, Any]) -> None:
    """Measured 0.87 to 1.57 of radiance, 0.57 to 1.51 as shown."""
    found = ratios(take(renderer, legacy(settings), samples=0), COUNTS, 512)
    assert beyond_a_factor_of_two(found) == {}


@pytest.mark.parametrize("name", ["default", "white", "ruby", "trio"])
def test_and_of_presets_under_lamps(renderer: Renderer, name: str) -> None:
    """Measured 0.86 to 1.49 of radiance, 0.74 to 1.44 as shown."""
    found = ratios(take(renderer, preset(name), samples=0), COUNTS, 384)
    assert beyond_a_factor_of_two(found) == {}


@pytest.mark.validation
@pytest.mark.parametrize("settings", SCENES.values(), ids=SCENES.keys())
def test_and_at_many_samples_too(renderer: Renderer, settings: dict[str, Any]) -> None:
    """Every number of samples from 2 to 256. Measured 0.78 to 1.96 of radiance, the most of the ruby at 96,
    0.53 to 1.77 as shown, the least of two samples of mirrors."""
    found = ratios(take(renderer, legacy(settings), samples=0), range(2, 257), 4096)
    assert beyond_a_factor_of_two(found) == {}


def test_one_sample_says_nothing_of_its_error(renderer: Renderer) -> None:
    assert np.isnan(take(renderer, LEGACY_DEFAULT).error_estimate())


def test_a_picture_without_edges_has_no_error(renderer: Renderer) -> None:
    scene = legacy({**BARE, "stones": [], "environment": {"kind": "constant"}})
    assert take(renderer, scene, samples=4).error_estimate() == 0
