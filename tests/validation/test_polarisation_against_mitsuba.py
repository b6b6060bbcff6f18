"""As `test_optics_against_mitsuba.py`, of polarised light: in a brilliant, in a skew block, and among three stones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from shared.stones import brilliant, skew_block
from validation.comparison import Verdict, compare, seen
from validation.mitsuba_reference import reference
from validation.test_optics_against_mitsuba import (
    AROUND_TRIO,
    INDICES,
    OUR_SAMPLES,
    SAMPLES,
    TRIO,
    TRIOS_INDICES,
    VIEWS,
    assert_same,
    scene_of,
    trio,
)

pytestmark = pytest.mark.validation

LAMPS = np.where(np.random.default_rng(5).random((8, 16)) < 0.5, 0.1, 1.0).repeat(8, axis=0).repeat(8, axis=1)
"""Patches of 22 degrees, bright or dim: no symmetry in which an error could hide. None is black: between black and
white Mitsuba's spectral variants interpolate otherwise."""
UPSAMPLED = 3e-4
"""They turn a grey of the panorama into a smooth spectrum, which is off by 1e-4."""


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
def test_polarised_light_in_a_brilliant(renderer: Renderer, number: int) -> None:
    compare_polarised_stone(renderer, brilliant(), number, (80, 45), SAMPLES)


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
def test_polarised_light_whose_plane_of_incidence_turns(renderer: Renderer, number: int) -> None:
    """In the skew block every reflection turns it, and total reflections shift phases between: wrong signs or frames
    cannot cancel. With few pixels, so many paths are enough to tell averaged polarisation apart."""
    polarised, averaged = compare_polarised_stone(renderer, skew_block(), number, (80, 45), 32 * SAMPLES)
    # measured 5.4, 8.4 and 13.8 times as many; 2e-26 is the lowest p
    assert averaged.beyond_two_sigma > 3 * polarised.beyond_two_sigma


def compare_polarised_stone(
    renderer: Renderer, stone: Shape, number: int, size: tuple[int, int], samples: int
) -> tuple[Verdict, Verdict]:
    view = list(VIEWS.values())[number]
    scenes, name = (scene_of(view, polarised=True), scene_of(view)), f"{stone.name}, {list(VIEWS)[number]}"
    return compare_polarised(renderer, name, scenes, [stone], [INDICES[number]], number, size, samples)


@pytest.mark.parametrize("number", range(3), ids=list(AROUND_TRIO))
def test_polarised_light_among_three_stones_that_touch(renderer: Renderer, number: int) -> None:
    scenes, shapes = (trio(number, polarised=True), trio(number)), [brilliant()] * len(TRIO)
    etas = [indices[number] for indices in TRIOS_INDICES]
    polarised, averaged = compare_polarised(
        renderer, f"trio, {list(AROUND_TRIO)[number]}", scenes, shapes, etas, number, (80, 45), 8 * SAMPLES
    )
    if list(AROUND_TRIO)[number] == "through one at the others":  # measured 10 times as many
        assert averaged.beyond_two_sigma > 2 * polarised.beyond_two_sigma


def compare_polarised(
    renderer: Renderer,
    name: str,
    scenes: tuple[Scene, Scene],
    shapes: Sequence[Shape],
    etas: Sequence[float],
    number: int,
    size: tuple[int, int],
    samples: int,
) -> tuple[Verdict, Verdict]:
    """Of a scene, polarised and averaged, judges the polarised mode, and returns the verdicts on both."""
    scene, without = scenes
    our_samples = OUR_SAMPLES * samples // SAMPLES
    ours = seen(renderer, scene, shapes, LAMPS, size, our_samples)
    theirs = reference(scene, shapes, etas, LAMPS.astype(np.float32), size, samples, polarised=True)
    polarised = compare(ours, number, theirs, UPSAMPLED)
    assert_same(f"{name}, polarised", ours, polarised, bias=UPSAMPLED)
    averaged = compare(seen(renderer, without, shapes, LAMPS, size, our_samples), number, theirs, UPSAMPLED)
    print(f"  without polarisation: {averaged}")
    return polarised, averaged
