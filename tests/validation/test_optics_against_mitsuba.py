"""culet and Mitsuba 3 render the same stones under the same skies, and differ by their noise alone.

Each case compares one channel, the first, second or third index of a dispersed stone by view, so that the program under
test is the one that serves. `python -m pytest -m validation -rP tests/validation` prints every verdict.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.optics.panoramas import directions
from culet.rendering.renderer import Renderer
from culet.scene import PRESETS, Scene
from culet.scene.legacy import legacy
from culet.simulation.staged import world_of
from culet.stage import Stage
from rendering.views import BARE, UPRIGHT
from shared.stones import brilliant, ring, skew_block, step_cut
from validation.comparison import Seen, Verdict, compare, seen
from validation.mitsuba_reference import Array, reference

pytestmark = pytest.mark.validation

SIZE = 320, 180
SAMPLES = 512
OUR_SAMPLES = 64
"""Each of culet's follows all parts of the light: they are noisy at edges only."""
INDICES = 1.6, 2.42, 2.0
STONES: dict[str, Callable[[], Shape]] = {"brilliant": brilliant, "step cut": step_cut, "ring": ring}
VIEWS: dict[str, dict[str, Any]] = {
    "from above": {"position": [0, 2.2, 2.0], "target": [0, -0.1, 0], "fov_degrees": 40},
    "down": {"position": [0.3, 2.8, 0.2], "target": [0, 0, 0], "up": [0, 0, -1], "fov_degrees": 40},
    "from below": {"position": [1.5, -2.0, 1.2], "target": [0, -0.1, 0], "fov_degrees": 40},
}
HEIGHT = np.broadcast_to(directions(64)[..., 1], (64, 128))
SKIES: dict[str, Array] = {"half": np.where(HEIGHT > 0, 1.0, 0.0), "gradient": (1 + HEIGHT) / 2}
LAMPS = np.where(np.random.default_rng(5).random((8, 16)) < 0.5, 0.1, 1.0).repeat(8, axis=0).repeat(8, axis=1)
"""Patches of 22 degrees, bright or dim: no symmetry in which an error could hide. None is black: between black and
white Mitsuba's spectral variants interpolate otherwise."""
UPSAMPLED = 3e-4
"""They turn a grey of the panorama into a smooth spectrum, which is off by 1e-4."""


ONE: list[dict[str, Any]] = [{**UPRIGHT, "material": {"ior": INDICES}}]


def scene_of(view: dict[str, Any], stones: list[dict[str, Any]] = ONE, **optics: object) -> Scene:
    return legacy(
        {
            **BARE,
            "stones": stones,
            "environment": {"kind": "image"},
            "camera": view,
            "optics": {"cutoff": 1e-4, "max_bounces": 65536, **optics},
        }
    )


@pytest.mark.parametrize("polarised", [False, True], ids=["scalar", "polarised"])
def test_both_look_the_panorama_up_alike(renderer: Renderer, polarised: bool) -> None:
    """Every direction of a sky of noise, pole and seam included, with no stone in the way."""
    sky = np.random.default_rng(1).random((64, 128))
    for up in (1, -1):
        view = {"position": [0, 0, 0], "target": [0.1, up, -0.2], "up": [0, 0, 1], "fov_degrees": 130}
        empty = scene_of(view).model_copy(update={"stones": ()})
        ours = seen(renderer, empty, (), sky, (160, 90), 64)
        theirs = reference(empty, (), (), sky.astype(np.float32), (160, 90), 64, polarised=polarised)
        verdict = compare(ours, 1, theirs)
        assert verdict.same, verdict
        assert abs(verdict.mean) < 3e-4


@pytest.mark.parametrize("sky", SKIES)
@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
@pytest.mark.parametrize("stone", STONES)
def test_unpolarised_light(renderer: Renderer, stone: str, number: int, sky: str) -> None:
    scene, solid, panorama = scene_of(list(VIEWS.values())[number]), STONES[stone](), SKIES[sky]
    ours = seen(renderer, scene, [solid], panorama, SIZE, OUR_SAMPLES)
    theirs = reference(scene, [solid], [INDICES[number]], panorama.astype(np.float32), SIZE, SAMPLES)
    assert_same(f"{stone}, {list(VIEWS)[number]}, {sky}", ours, compare(ours, number, theirs), bias=0)


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
def test_polarised_light_in_a_brilliant(renderer: Renderer, number: int) -> None:
    compare_polarised_stone(renderer, brilliant(), number, SIZE, SAMPLES)


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
def test_polarised_light_whose_plane_of_incidence_turns(renderer: Renderer, number: int) -> None:
    """In the skew block every reflection turns it, and total reflections shift phases between: wrong signs or frames
    cannot cancel. With a sixteenth of the pixels, as many paths are enough to tell averaged polarisation apart."""
    polarised, averaged = compare_polarised_stone(
        renderer, skew_block(), number, (SIZE[0] // 4, SIZE[1] // 4), 16 * SAMPLES
    )
    # measured 3.8, 7.8 and 10.6 times as many; 5e-16 is the lowest p
    assert averaged.beyond_two_sigma > 3 * polarised.beyond_two_sigma


def compare_polarised_stone(
    renderer: Renderer, stone: Shape, number: int, size: tuple[int, int], samples: int
) -> tuple[Verdict, Verdict]:
    view = list(VIEWS.values())[number]
    scenes, name = (scene_of(view, polarised=True), scene_of(view)), f"{stone.name}, {list(VIEWS)[number]}"
    return compare_polarised(renderer, name, scenes, [stone], [INDICES[number]], number, size, samples)


TRIO = PRESETS["trio"].scene.stones
"""Two that each touch the third, of three sizes and turned."""
TRIOS_INDICES = INDICES, (2.42, 1.77, 1.52), (1.77, 1.5, 2.42)
"""By stone and view."""
AROUND_TRIO: dict[str, dict[str, Any]] = {
    "from above": {"position": [0, 5.0, 5.0], "target": [0, -0.4, 0.2], "fov_degrees": 36},
    "through one at the others": {"position": [5.5, 0.4, 1.5], "target": [0, -0.4, 0.2], "fov_degrees": 28},
    "from below": {"position": [-2.5, -5.5, 2.0], "target": [0, -0.4, 0.2], "fov_degrees": 36},
}
TRIOS_SIZE = 160, 90


def trio(number: int, **optics: object) -> Scene:
    stones = [
        {**stone.model_dump(exclude={"absorption"}), "material": {"ior": indices}}
        for stone, indices in zip(TRIO, TRIOS_INDICES, strict=True)
    ]
    return scene_of(list(AROUND_TRIO.values())[number], stones, **optics)


def test_the_stones_of_the_trio_touch() -> None:
    world = world_of(Stage.of(PRESETS["trio"].scene))
    one, *others = (body.name for body in world.bodies)
    assert [abs(world.separation(one, other)) < 1e-5 for other in others] == [True, True]


@pytest.mark.parametrize("sky", SKIES)
@pytest.mark.parametrize("number", range(3), ids=list(AROUND_TRIO))
def test_light_among_three_stones_that_touch(renderer: Renderer, number: int, sky: str) -> None:
    scene, panorama, shapes = trio(number), SKIES[sky], [brilliant()] * len(TRIO)
    etas = [indices[number] for indices in TRIOS_INDICES]
    ours = seen(renderer, scene, shapes, panorama, TRIOS_SIZE, OUR_SAMPLES)
    theirs = reference(scene, shapes, etas, panorama.astype(np.float32), TRIOS_SIZE, SAMPLES)
    assert_same(f"trio, {list(AROUND_TRIO)[number]}, {sky}", ours, compare(ours, number, theirs), bias=0)


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


def assert_same(name: str, ours: Seen, verdict: Verdict, bias: float) -> None:
    print(f"{name}: {verdict}")
    assert ours.on_stone.mean() > 0.1
    assert verdict.same, verdict
    assert verdict.beyond_two_sigma < 0.05
    assert abs(verdict.mean) < 4 * verdict.sigma + bias * ours.mean.mean()
