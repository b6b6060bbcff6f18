"""A prism: the way a ray takes is read off a sky whose radiance is affine in the height that the ray points at."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from optics.closed_forms import DIAMOND, deviation, fresnel, minimum_deviation
from rendering.views import BARE, UPRIGHT, radiance, take
from shared.stones import prism

LEFT = 0
"""The facet that the ray enters by."""


def measured_deviation(
    renderer: Renderer, stone: Shape, apex: float, indices: tuple[float, float, float], incidence: float
) -> list[float]:
    """Degrees by which each channel's ray is turned; it enters in the middle of the left facet, rising.

    One interior segment is followed, so a pixel is R1 sky(reflected) + (1 - R1)(1 - R2) sky(deviated), sky = (1 + y)/2.
    """
    normal, offset = stone.planes[LEFT, :3], stone.planes[LEFT, 3]
    entry = np.array([offset / normal[0], 0, 0])
    # The facet's inward normal points apex/2 below the horizontal; the ray comes from below it.
    rise = incidence - apex / 2
    direction = np.array([math.cos(rise), math.sin(rise), 0])
    scene = legacy(
        {
            **BARE,
            "stones": [{**UPRIGHT, "material": {"ior": indices}}],
            "environment": {"kind": "gradient"},
            "camera": {"position": (entry - 3 * direction).tolist(), "target": entry.tolist(), "fov_degrees": 1e-3},
            "optics": {"max_bounces": 1, "cutoff": 1e-9},
        }
    )
    pixel = radiance(take(renderer, scene, stone, (1, 1)))[0, 0]
    reflected = direction - 2 * (direction @ normal) * normal
    turned = []
    for n, seen in zip(indices, pixel, strict=True):
        inner = apex - math.asin(math.sin(incidence) / n)
        r1, r2 = fresnel(math.sin(incidence), 1, n), fresnel(math.sin(inner), n, 1)
        sky = (seen - r1 * (1 + reflected[1]) / 2) / ((1 - r1) * (1 - r2))
        turned.append(math.degrees(rise - math.asin(2 * sky - 1)))
    return turned


@pytest.mark.parametrize(("apex", "published"), [(20, 29.643), (30, 47.466), (40, 71.549)])
def test_a_diamond_prism_turns_light_by_the_minimum_deviation(
    renderer: Renderer, exact: Renderer, apex: float, published: float
) -> None:
    stone, a = prism(apex), math.radians(apex)
    least = minimum_deviation(DIAMOND, a)
    symmetric = (least + a) / 2
    for used, tolerance in ((renderer, 6e-5), (exact, 1e-13)):  # degrees; measured 1.8e-5 and 2.9e-14
        turned = measured_deviation(used, stone, a, (DIAMOND,) * 3, symmetric)
        assert turned == pytest.approx([math.degrees(least)] * 3, abs=tolerance)
        assert turned == pytest.approx([published] * 3, abs=6e-4)


@pytest.mark.parametrize("offset", [-20, -8, 8, 20])
def test_away_from_the_symmetric_passage_light_is_turned_more(exact: Renderer, offset: float) -> None:
    stone, a = prism(30), math.radians(30)
    least = minimum_deviation(DIAMOND, a)
    incidence = (least + a) / 2 + math.radians(offset)
    turned = measured_deviation(exact, stone, a, (DIAMOND,) * 3, incidence)
    assert turned == pytest.approx(
        [math.degrees(deviation(DIAMOND, a, incidence))] * 3, abs=1.5e-13
    )  # measured 4.3e-14
    assert turned[0] > math.degrees(least) + 0.1


def test_a_prism_turns_each_channel_by_its_own_index(renderer: Renderer, exact: Renderer) -> None:
    stone, a, indices = prism(40), math.radians(40), (1.7, 1.8, 1.9)
    expected = [math.degrees(deviation(n, a, math.radians(45))) for n in indices]
    assert expected[2] - expected[0] > 9  # degrees: a wide spectrum
    for used, tolerance in ((renderer, 2e-5), (exact, 1e-13)):  # measured 5.7e-6 and 2.9e-14
        assert measured_deviation(used, stone, a, indices, math.radians(45)) == pytest.approx(expected, abs=tolerance)
