"""Sampled wavelengths: each goes its own way, and white stays white."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from culet.optics.materials import material_of
from culet.rendering.chains import GROUPS, chain_table
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
from optics.closed_forms import deviation, fresnel, minimum_deviation
from rendering.views import BARE, UPRIGHT, Array, radiance, take
from shared.stages import staged
from shared.stones import prism

APEX = math.radians(40)
LEFT = 0


def seen_through_a_prism(renderer: Renderer, scene: dict[str, Any], incidence: float, size: int) -> Array:
    """(size, size, 3) the ray that enters the left facet's middle at that angle, followed over one segment."""
    stone = prism(40)
    normal, offset = stone.planes[LEFT, :3], stone.planes[LEFT, 3]
    entry = np.array([offset / normal[0], 0, 0])
    rise = incidence - APEX / 2
    direction = np.array([math.cos(rise), math.sin(rise), 0])
    camera = {"position": (entry - 3 * direction).tolist(), "target": entry.tolist(), "fov_degrees": 1e-3}
    return radiance(take(renderer, legacy({**BARE, "camera": camera, **scene}), stone, (size, size)))


def sky_at(incidence: float, n: Array) -> Array:
    """What each wavelength shows of a gradient sky by way of the prism's facets, in closed form."""
    rise, reflected_rise = incidence - APEX / 2, math.pi - APEX / 2 - incidence
    shown = []
    for index in n:
        inner = APEX - math.asin(math.sin(incidence) / index)
        first, second = fresnel(math.sin(incidence), 1, index), fresnel(math.sin(inner), index, 1)
        turned = rise - deviation(index, APEX, incidence)
        seen_reflected, seen_turned = (0.5 * (1 + math.sin(angle)) for angle in (reflected_rise, turned))
        shown.append(first * seen_reflected + (1 - first) * (1 - second) * seen_turned)
    return np.array(shown)


@pytest.mark.parametrize("bands", [4, 16])
def test_each_wavelength_is_turned_by_the_prism_as_its_index_says(
    renderer: Renderer, exact: Renderer, bands: int
) -> None:
    """Near minimum deviation of the green: the sum over each group's wavelengths, weighted, of closed forms."""
    n_green = float(material_of("diamond").index(np.array([546.1]))[0])
    incidence = (minimum_deviation(n_green, APEX) + APEX) / 2
    settings = {
        "stones": [{**UPRIGHT, "material": "diamond"}],
        "environment": {"kind": "gradient"},
        "optics": {"bands": bands, "max_bounces": 1, "cutoff": 1e-9},
    }
    chains = chain_table(legacy({**BARE, **settings}), 0, np.float64, common=False)
    expected = np.array(
        [chains["share"][group::GROUPS].T @ sky_at(incidence, chains["eta"][group::GROUPS]) for group in range(GROUPS)]
    )
    for used in (renderer, exact):
        pixels = seen_through_a_prism(used, settings, incidence, 2).reshape(4, 3)
        # Which pixel of a square takes which group is the sample's affair: all four are there.
        distance = abs(pixels[:, None] - expected[None]).max(axis=-1)
        assert sorted(distance.argmin(axis=1)) == [0, 1, 2, 3]
        # measured 1.9e-6: a quarter of the picture's thousandth of a degree, by which pixels lie beside the middle
        assert distance.min(axis=1).max() < 4e-6


def test_violet_bends_most(exact: Renderer) -> None:
    """What is turned by more than the green is blue, and what is turned by less is red."""
    n = material_of("diamond").index(np.array([656.3, 546.1, 435.8]))
    incidence = math.radians(52)
    turned = [deviation(float(index), APEX, incidence) for index in n]
    assert turned[0] < turned[1] < turned[2]
    rise = incidence - APEX / 2
    edge, sky = rise - turned[1], np.zeros((512, 1024, 3), np.float32)
    elevation = np.pi / 2 - (np.arange(512) + 0.5) * np.pi / 512
    panoramas = {"more": elevation < edge, "less": elevation > edge}
    colour = {}
    stone = prism(40)
    normal, offset = stone.planes[LEFT, :3], stone.planes[LEFT, 3]
    entry = np.array([offset / normal[0], 0, 0])
    direction = np.array([math.cos(rise), math.sin(rise), 0])
    scene = legacy(
        {
            **BARE,
            "stones": [{**UPRIGHT, "material": "diamond"}],
            "environment": {"kind": "image"},
            "camera": {"position": (entry - 3 * direction).tolist(), "target": entry.tolist(), "fov_degrees": 1e-3},
            "optics": {"bands": 32, "max_bounces": 1, "cutoff": 1e-9},
        }
    )
    for name, lit in panoramas.items():
        panorama = sky.copy()
        panorama[lit & (abs(elevation - edge) < 0.3)] = 1  # narrow, so that the reflection sees none of it
        picture = exact.picture(staged(scene, stone, panorama), 2, 2)
        picture.refine()
        colour[name] = radiance(picture).mean(axis=(0, 1))
    assert colour["more"][2] > 3 * colour["more"][0]
    assert colour["less"][0] > 3 * colour["less"][2]


def under_white(bands: int, *, polarised: bool) -> Scene:
    return legacy(
        {
            **BARE,
            "environment": {"kind": "constant"},
            "optics": {"bands": bands, "cutoff": 1e-7, "max_bounces": 65536, "polarised": polarised},
        }
    )


def test_white_is_nowhere_more_than_white(exact: Renderer) -> None:
    """In double precision, where nothing but what is cut is seen of the difference."""
    picture = take(exact, under_white(64, polarised=False), size=(64, 36), samples=3)
    missing = 1 - radiance(picture)
    assert missing.min() > -1e-12
    assert missing.max() < 3 * picture.cut_map().max()


@pytest.mark.parametrize("polarised", [False, True])
@pytest.mark.parametrize("bands", [4, 5, 7, 16, 33, 64])
def test_white_stays_white(renderer: Renderer, bands: int, polarised: bool) -> None:
    """Under a white sky each pixel is as grey as its weights: their sum is 1 in each group. What is cut may differ by
    wavelength. A pixel of 64 bands adds up some hundred parts, whose roundings add 1.8e-6 at most."""
    scene = under_white(bands, polarised=polarised)
    picture = take(renderer, scene, size=(64, 36), samples=3)
    pixels = radiance(picture)
    assert abs(pixels - 1).max() < 2.5e-6 + 3 * picture.cut_map().max()
    assert picture.cut_map().max() < 5e-6
    without = radiance(take(renderer, scene.model_copy(update={"stones": ()}), size=(8, 8)))
    assert (without == 1).all()


def test_a_spectral_picture_is_the_weighted_sum_of_pictures_of_one_index(exact: Renderer) -> None:
    """Four wavelengths for each of four groups, traced once together and once one by one."""
    base = {**BARE, "environment": {"kind": "gradient"}}
    spectral = legacy({**base, "optics": {"bands": 4}})
    together = radiance(take(exact, spectral, size=(48, 28)))
    chains = chain_table(spectral, 0, np.float64, common=False)
    alone = np.zeros((GROUPS, *together.shape))
    for number, chain in enumerate(chains):
        scene = legacy({**base, "stones": [{"material": {"ior": [chain["eta"]] * 3}}]})
        alone[number % GROUPS] += chain["share"] * radiance(take(exact, scene, size=(48, 28)))
    height, width, _ = together.shape
    group = np.arange(width)[None, :] % 2 + 2 * (np.arange(height)[:, None] % 2)
    expected = np.take_along_axis(alone, group[None, ..., None], axis=0)[0]
    assert together == pytest.approx(expected, abs=1e-13)
