"""culet and Mitsuba 3 render the same stones under the same skies, and differ by their noise alone.

Each case compares one channel, the first, second or third index of a dispersed stone by view, so that the program under
test is the one that serves. `python -m pytest -m validation -rP tests/validation` prints every verdict.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.optics.panoramas import directions
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
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


def scene_of(view: dict[str, Any], **optics: object) -> Scene:
    return legacy(
        {
            **BARE,
            "stones": [{**UPRIGHT, "material": {"ior": INDICES}}],
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
        ours = seen(renderer, scene_of(view).model_copy(update={"stones": ()}), None, sky, (160, 90), 64)
        theirs = reference(scene_of(view), None, 1, sky.astype(np.float32), (160, 90), 64, polarised=polarised)
        verdict = compare(ours, 1, theirs)
        assert verdict.same, verdict
        assert abs(verdict.mean) < 3e-4


@pytest.mark.parametrize("sky", SKIES)
@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
@pytest.mark.parametrize("stone", STONES)
def test_unpolarised_light(renderer: Renderer, stone: str, number: int, sky: str) -> None:
    scene, solid, panorama = scene_of(list(VIEWS.values())[number]), STONES[stone](), SKIES[sky]
    ours = seen(renderer, scene, solid, panorama, SIZE, OUR_SAMPLES)
    theirs = reference(scene, solid, INDICES[number], panorama.astype(np.float32), SIZE, SAMPLES)
    assert_same(f"{stone}, {list(VIEWS)[number]}, {sky}", ours, compare(ours, number, theirs), bias=0)


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
def test_polarised_light_in_a_brilliant(renderer: Renderer, number: int) -> None:
    compare_polarised(renderer, brilliant(), number, SIZE, SAMPLES)


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
def test_polarised_light_whose_plane_of_incidence_turns(renderer: Renderer, number: int) -> None:
    """In the skew block every reflection turns it, and total reflections shift phases between: wrong signs or frames
    cannot cancel. With a sixteenth of the pixels, as many paths are enough to tell averaged polarisation apart."""
    polarised, averaged = compare_polarised(renderer, skew_block(), number, (SIZE[0] // 4, SIZE[1] // 4), 16 * SAMPLES)
    # measured 3.8, 7.8 and 10.6 times as many; 5e-16 is the lowest p
    assert averaged.beyond_two_sigma > 3 * polarised.beyond_two_sigma


def compare_polarised(
    renderer: Renderer, stone: Shape, number: int, size: tuple[int, int], samples: int
) -> tuple[Verdict, Verdict]:
    """Judges the polarised mode, and returns the verdicts on it and on the averaged one."""
    view = list(VIEWS.values())[number]
    name = f"{stone.name}, {list(VIEWS)[number]}, polarised"
    scene = scene_of(view, polarised=True)
    our_samples = OUR_SAMPLES * samples // SAMPLES
    ours = seen(renderer, scene, stone, LAMPS, size, our_samples)
    theirs = reference(scene, stone, INDICES[number], LAMPS.astype(np.float32), size, samples, polarised=True)
    polarised = compare(ours, number, theirs, UPSAMPLED)
    assert_same(name, ours, polarised, bias=UPSAMPLED)
    averaged = compare(seen(renderer, scene_of(view), stone, LAMPS, size, our_samples), number, theirs, UPSAMPLED)
    print(f"  without polarisation: {averaged}")
    return polarised, averaged


def assert_same(name: str, ours: Seen, verdict: Verdict, bias: float) -> None:
    print(f"{name}: {verdict}")
    assert ours.on_stone.mean() > 0.1
    assert verdict.same, verdict
    assert verdict.beyond_two_sigma < 0.05
    assert abs(verdict.mean) < 4 * verdict.sigma + bias * ours.mean.mean()
