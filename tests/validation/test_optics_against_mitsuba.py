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
from culet.scene import PRESETS, Scene
from culet.scene.legacy import legacy
from culet.simulation.staged import world_of
from culet.stage import Stage
from rendering.views import BARE, UPRIGHT
from shared.stones import brilliant, ring, step_cut
from validation.comparison import Seen, Verdict, compare, seen
from validation.mitsuba_reference import Array, reference

pytestmark = pytest.mark.validation

SIZE = 160, 90
"""Enough to see an index that is off by 0.2 %, with p of 1e-9. Four times as many do not show one of 0.1 % either."""
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


def sky_of(*place: int) -> str:
    """By turns: each stone and each view is seen under both, which show what is wrong as well."""
    return list(SKIES)[sum(place) % len(SKIES)]


@pytest.mark.parametrize("number", range(3), ids=list(VIEWS))
@pytest.mark.parametrize("stone", STONES)
def test_unpolarised_light(renderer: Renderer, stone: str, number: int) -> None:
    sky = sky_of(list(STONES).index(stone), number)
    scene, solid, panorama = scene_of(list(VIEWS.values())[number]), STONES[stone](), SKIES[sky]
    ours = seen(renderer, scene, [solid], panorama, SIZE, OUR_SAMPLES)
    theirs = reference(scene, [solid], [INDICES[number]], panorama.astype(np.float32), SIZE, SAMPLES)
    assert_same(f"{stone}, {list(VIEWS)[number]}, {sky}", ours, compare(ours, number, theirs), bias=0)


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


@pytest.mark.parametrize("number", range(3), ids=list(AROUND_TRIO))
def test_light_among_three_stones_that_touch(renderer: Renderer, number: int) -> None:
    sky = sky_of(number)
    scene, panorama, shapes = trio(number), SKIES[sky], [brilliant()] * len(TRIO)
    etas = [indices[number] for indices in TRIOS_INDICES]
    ours = seen(renderer, scene, shapes, panorama, TRIOS_SIZE, OUR_SAMPLES)
    theirs = reference(scene, shapes, etas, panorama.astype(np.float32), TRIOS_SIZE, SAMPLES)
    assert_same(f"trio, {list(AROUND_TRIO)[number]}, {sky}", ours, compare(ours, number, theirs), bias=0)


def assert_same(name: str, ours: Seen, verdict: Verdict, bias: float) -> None:
    print(f"{name}: {verdict}")
    assert ours.on_stone.mean() > 0.1
    assert verdict.same, verdict
    assert verdict.beyond_two_sigma < 0.05
    assert abs(verdict.mean) < 4 * verdict.sigma + bias * ours.mean.mean()
