"""The table of extremes in docs/explanation/accuracy.md: every count in it is zero, and it counts what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from culet.rendering.features import Features
from culet.rendering.renderer import Renderer
from culet.scene.legacy import LEGACY_DEFAULT
from culet.study.renderer.extremes import EXTREMES, MODES, ROUNDING, SceneExtreme, _judged, count
from rendering.views import program_between_few_mirrors

MANY = (
    "rays at every vertex",
    "rays at and along every edge",
    "camera on every facet",
    "5000 facets",
    "needle, 1000 : 1",
)
"""Cases that take seconds."""
QUICK = [extreme for extreme in EXTREMES if extreme.name not in MANY]


def general(needed: Features) -> Features:
    """One for all cases, but of stones between few mirrors."""
    return program_between_few_mirrors(needed) or needed.general


def special(needed: Features) -> Features:
    """One for each, as the table has them."""
    return needed


def assert_nothing_wrong(
    renderer: Renderer, extreme: SceneExtreme, mode: str, program: Callable[[Features], Features]
) -> None:
    found = count(renderer, extreme, mode, program=program)
    assert found.pixels > 0
    assert (found.not_finite, found.negative, found.specks) == (0, 0, 0), found
    assert found.farthest < ROUNDING


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("extreme", QUICK, ids=lambda extreme: extreme.name)
def test_no_pixel_is_wrong(renderer: Renderer, extreme: SceneExtreme, mode: str) -> None:
    assert_nothing_wrong(renderer, extreme, mode, general)


@pytest.mark.validation
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("extreme", EXTREMES, ids=lambda extreme: extreme.name)
def test_no_pixel_of_any_case_is_wrong_in_its_own_program(renderer: Renderer, extreme: SceneExtreme, mode: str) -> None:
    assert_nothing_wrong(renderer, extreme, mode, special)


def test_what_is_wrong_is_counted() -> None:
    """One pixel each: NaN, negative, too dark for what it cut, too bright; and four that are right."""
    pixels = np.ones((2, 4, 3))
    pixels[0] = [[np.nan, 1, 1], [-0.1, 1, 1], [0.9, 0.9, 0.9], [1.1, 1, 1]]
    cut = np.zeros((2, 4))
    pixels[1, 0], cut[1, 0] = 0.995, 0.005
    found = _judged(LEGACY_DEFAULT, None, pixels, cut)
    assert (found.pixels, found.not_finite, found.negative, found.specks) == (8, 1, 1, 3)


def test_a_ray_that_is_lost_is_a_speck_though_it_is_counted_as_cut() -> None:
    pixels, cut = np.zeros((1, 2, 3)), np.ones((1, 2))
    assert _judged(LEGACY_DEFAULT, None, pixels, cut).specks == 2


def test_the_page_shows_every_case() -> None:
    page = (Path(__file__).parents[2] / "docs" / "explanation" / "accuracy.md").read_text(encoding="utf-8")
    for extreme in EXTREMES:
        assert f"| {extreme.name} |" in page
