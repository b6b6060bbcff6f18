"""A plate in incoherent light: echoes between two parallel facets, summed in closed form.

Averaging both polarisations at each facet is part of the model: at 60 degrees the plate passes 0.6511, where light that
keeps its polarisation would pass 0.6949. The expected values are the model's.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from optics.closed_forms import DIAMOND, fresnel, slab
from rendering.views import BARE, UPRIGHT, Array, radiance, take
from shared.stones import slab as slab_stone

HALF_HEIGHT = 0.01
"""R; light that is seen at 75 degrees moves 0.009 R sideways in each passage, the chain ends before the plate does."""


def seen_from_above(
    renderer: Renderer,
    degrees: float,
    stone: dict[str, Any],
    environment: dict[str, Any],
    millimetres: float = 1,
    **optics: object,
) -> Array:
    """(3,) radiance in the middle of the plate, seen that far from vertical."""
    angle = math.radians(degrees)
    position = [0, 4 * math.cos(angle), 4 * math.sin(angle)]
    scene = legacy(
        {
            **BARE,
            "millimetres": millimetres,
            "stones": [{**UPRIGHT, **stone}],
            "environment": environment,
            "camera": {"position": position, "target": [0, 0, 0], "up": [0, 0, -1], "fov_degrees": 1e-3},
            "optics": {"cutoff": 1e-9, **optics},
        }
    )
    picture = take(renderer, scene, slab_stone(HALF_HEIGHT), (5, 5))
    pixels = radiance(picture)
    assert np.ptp(pixels, axis=(0, 1)).max() < 3e-5  # the plate looks the same all over
    assert picture.cut() < 1e-8
    middle: Array = pixels[2, 2]
    return middle


def test_a_plate_under_a_half_lit_sky_returns_twice_r_over_one_plus_r(renderer: Renderer, exact: Renderer) -> None:
    """2R/(1+R) = 0.29357 for n = 2.41749: what both facets reflect between them, if no echo is lost."""
    material = {"material": {"ior": [DIAMOND] * 3}}
    for used, tolerance in ((renderer, 3e-8), (exact, 3e-10)):  # measured 7.7e-9 and 8.2e-11
        seen = seen_from_above(used, 0, material, {"kind": "half"})
        assert seen == pytest.approx(slab(fresnel(0, 1, DIAMOND))[1], abs=tolerance)
        assert seen == pytest.approx(0.29357, abs=2e-6)


@pytest.mark.parametrize("degrees", [0, 30, 60, 75])
def test_each_channel_sees_the_echoes_of_its_own_index(exact: Renderer, degrees: float) -> None:
    indices = (1.5, DIAMOND, 4.0)
    seen = seen_from_above(exact, degrees, {"material": {"ior": indices}}, {"kind": "half"})
    expected = [slab(fresnel(math.sin(math.radians(degrees)), 1, n))[1] for n in indices]
    assert seen == pytest.approx(expected, abs=2e-9)  # measured 6.7e-10, the cut-off


def test_the_transmittances_are_the_published_ones(exact: Renderer) -> None:
    """0.7064, 0.7043, 0.6511, 0.5032 of a diamond plate at 0, 30, 60 and 75 degrees, under light from below only."""
    from_below = {"kind": "gradient", "bottom": [1, 1, 1], "top": [0, 0, 0]}
    for degrees, passed in ((0, 0.7064), (30, 0.7043), (60, 0.6511), (75, 0.5032)):
        seen = seen_from_above(exact, degrees, {"material": {"ior": [DIAMOND] * 3}}, from_below)
        # Light leaves upward or downward under the angle of sight: the sky there is (1 -+ cosine) / 2.
        cosine = math.cos(math.radians(degrees))
        transmittance = (seen - (1 - cosine) / 2) / cosine
        assert transmittance == pytest.approx(passed, abs=6e-5)


@pytest.mark.parametrize("degrees", [0, 45])
@pytest.mark.parametrize("dispersed", [False, True])
def test_light_is_absorbed_on_every_passage(exact: Renderer, degrees: float, dispersed: bool) -> None:
    """T = (1-R)^2 a / (1 - R^2 a^2) and R + R (1-R)^2 a^2 / (1 - R^2 a^2), a different a in each channel."""
    indices = (1.7, 1.8, 1.9) if dispersed else (DIAMOND,) * 3
    coefficients = (0.0, 25.0, 400.0)
    sine = math.sin(math.radians(degrees))
    expected = []
    for n, coefficient in zip(indices, coefficients, strict=True):
        way = 2 * HALF_HEIGHT / math.sqrt(1 - (sine / n) ** 2)
        passed, returned = slab(fresnel(sine, 1, n), math.exp(-coefficient * way))
        cosine = math.cos(math.radians(degrees))
        expected.append(returned * (1 + cosine) / 2 + passed * (1 - cosine) / 2)
    stone = {"material": {"ior": indices}, "absorption": coefficients}
    seen = seen_from_above(exact, degrees, stone, {"kind": "gradient"})
    assert seen == pytest.approx(expected, abs=1e-9)  # measured 3.7e-10


def test_an_absorbing_plate_has_the_published_reflectance(renderer: Renderer) -> None:
    """0.215902 where one passage leaves exp(-1/2), n = 2.41749."""
    stone = {"material": {"ior": [DIAMOND] * 3}, "absorption": [0.5 / (2 * HALF_HEIGHT)] * 3}
    assert seen_from_above(renderer, 0, stone, {"kind": "half"}) == pytest.approx(0.215902, abs=6e-7)


def test_a_size_does_not_change_an_absorption_that_is_asked_for(exact: Renderer) -> None:
    """Which is per R, as all lengths are; only a material's own colour depends on how many millimetres that is."""
    stone, sky = {"material": "classic", "absorption": [3, 6, 9]}, {"kind": "half"}
    small, large = (seen_from_above(exact, 20, stone, sky, millimetres=size) for size in (0.1, 30))
    assert small.tolist() == large.tolist()


def test_a_plate_with_schlicks_reflectance_has_his_echoes(exact: Renderer) -> None:
    cosine = math.cos(math.radians(60))
    at_normal = ((DIAMOND - 1) / (DIAMOND + 1)) ** 2
    schlick = at_normal + (1 - at_normal) * (1 - cosine) ** 5
    seen = seen_from_above(exact, 60, {"material": {"ior": [DIAMOND] * 3}}, {"kind": "half"}, fresnel="schlick")
    assert seen == pytest.approx(slab(schlick)[1], abs=1.5e-9)  # measured 4.8e-10
