"""Pictures that are refined until they are good enough."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from culet.errors import InputError
from culet.optics.gamut import into_gamut
from culet.optics.tone import TONE_MAPS, tone_map
from culet.rendering.film.doublings import MOST, Doublings
from culet.rendering.film.target import Target
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT, legacy
from rendering.views import radiance, take

SIZE = 150, 70
"""No multiple of what the kernels take at a time."""


def refined(renderer: Renderer, scene: Scene, target: Target, *, seconds: float = math.inf) -> DevicePicture:
    picture = take(renderer, scene, size=SIZE, samples=0)
    for _ in picture.refine_until(target, seconds):
        pass
    return picture


@pytest.mark.parametrize("optics", [{}, {"bands": 8}], ids=["three", "spectral"])
@pytest.mark.parametrize("name", TONE_MAPS)
def test_halves_are_compared_as_the_film_shows_them(renderer: Renderer, name: str, optics: dict[str, Any]) -> None:
    """Of two samples: half the difference of the first and the second, by the formulas in double precision."""
    scene = legacy({"film": {"tone_map": name, "exposure": 2.5}, "optics": optics})
    first = radiance(refined(renderer, scene, Target(1)))
    picture = refined(renderer, scene, Target(2))
    halves = first, 2 * radiance(picture) - first
    shown = [np.clip(tone_map(into_gamut(2.5 * half, scene.film.gamut), name), 0, 1) for half in halves]
    expected = math.sqrt(((shown[0] - shown[1]) ** 2).mean()) / 2
    assert picture.shown_error() == pytest.approx(expected, rel=2e-4)


def test_a_target_is_met_by_as_many_samples_as_it_needs(renderer: Renderer) -> None:
    """Not only by powers of two: 0.03 is met between them."""
    picture = refined(renderer, LEGACY_DEFAULT, Target(1000, 0.03))
    assert picture.meets(Target(1000, 0.03))
    assert picture.shown_error() <= 0.03 * (1 + 1e-9)
    before = refined(renderer, LEGACY_DEFAULT, Target(picture.samples - 1))
    assert before.shown_error() > 0.03
    assert picture.samples.bit_count() > 1, "a power of two, of which this test says nothing"


def test_samples_end_what_the_error_does_not(renderer: Renderer) -> None:
    target = Target(5, 1e-6)
    picture = refined(renderer, LEGACY_DEFAULT, target)
    assert (picture.samples, picture.reached(target), picture.meets(target)) == (5, True, False)


def test_so_many_samples_are_taken_whatever_the_error(renderer: Renderer) -> None:
    assert refined(renderer, LEGACY_DEFAULT, Target(100, 1, least=7)).samples == 7


def test_a_single_sample_meets_no_error(renderer: Renderer) -> None:
    """Nothing is known of it."""
    picture = refined(renderer, LEGACY_DEFAULT, Target(1, 1))
    assert math.isnan(picture.shown_error())
    assert not picture.meets(Target(1, 1))


def test_a_target_is_reached_with_the_same_bits_however_often_it_is_left(renderer: Renderer) -> None:
    target = Target(1000, 0.03)
    expected = refined(renderer, LEGACY_DEFAULT, target)
    picture, turns = take(renderer, LEGACY_DEFAULT, size=SIZE, samples=1), 0
    while not picture.reached(target):
        turns += 1
        before = picture.samples
        for _ in picture.refine_until(target, 1e-4, pause=lambda: True):
            pass
        assert picture.samples == before + 1
    assert turns == expected.samples - 1
    assert picture.linear().tobytes() == expected.linear().tobytes()
    assert picture.shown_error() == expected.shown_error()


def test_the_part_that_is_done_ends_at_the_whole(renderer: Renderer) -> None:
    picture = take(renderer, LEGACY_DEFAULT, size=SIZE, samples=0)
    parts = list(picture.refine_until(Target(1000, 0.03), math.inf))
    assert all(0 <= part <= 1 for part in parts)
    assert parts[-1] == 1


@pytest.mark.parametrize(
    ("samples", "error", "field"), [(0, None, "samples"), (65537, 0.1, "samples"), (1, 0, "error"), (1, 1.5, "error")]
)
def test_a_target_that_no_picture_can_have_is_refused(samples: int, error: float | None, field: str) -> None:
    with pytest.raises(InputError, match=f"^{field}: expected .*, got "):
        Target(samples, error)


@pytest.mark.parametrize(("own", "least", "most"), [(1, 16, 256), (40, 40, 256), (300, 300, 300)])
def test_a_still_looks_right_unless_somebody_asks_for_something_else(own: int, least: int, most: int) -> None:
    """It has the samples that its scene says at least, and those that an error of 0.01 takes."""
    scene = Scene.read({"sampling": {"samples_per_pixel": own}})
    assert Target.of(None, None, scene) == Target(most, 0.01, least=least)


def test_what_is_asked_for_of_a_still_counts_and_not_what_its_scene_says() -> None:
    scene = Scene.read({"sampling": {"samples_per_pixel": 40}})
    asked = [Target.of(samples, error, scene) for samples, error in ((5, None), (None, 0.1), (5, 0.1))]
    assert [(each.samples, each.error, each.least) for each in asked] == [(5, None, 2), (65536, 0.1, 2), (5, 0.1, 2)]


@pytest.mark.parametrize("error", [1e-300, 5e-324])
def test_an_error_that_no_number_of_samples_meets_is_a_limit_that_is_not_met(renderer: Renderer, error: float) -> None:
    picture = take(renderer, LEGACY_DEFAULT, samples=0)
    for _ in picture.refine_until(Target(4, error), math.inf):
        pass
    assert picture.samples == 4
    assert not picture.meets(Target(4, error))


def test_without_a_number_for_the_error_all_samples_are_taken() -> None:
    halves = Doublings()
    halves.add(2, math.nan, 3)
    assert halves.samples_for(0.01) == MOST
