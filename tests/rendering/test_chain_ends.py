"""Three ends of a chain whose weight is below the cut-off: dropped, the sky in its place, or on by chance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.stage import Stage
from rendering.views import BARE, UPRIGHT, Array, radiance, take

VIEW: dict[str, Any] = {
    **BARE,
    "environment": {"kind": "half"},
    "stones": [UPRIGHT],
    "camera": {"position": [0.4, 2.4, 2.2], "target": [0, 0, 0], "fov_degrees": 40},
}


def scene(**optics: object) -> Scene:
    return legacy({**VIEW, "optics": {"max_bounces": 65536, **optics}})


def means_by_sample(renderer: Renderer, samples: int, **optics: object) -> Array:
    """(samples,) the whole picture's mean radiance in each sample."""
    shown = scene(**optics)
    picture = renderer.picture(Stage.of(shown), 48, 28)
    sums = [0.0]
    for number in range(samples):
        picture.refine()
        sums.append(float(radiance(picture).mean()) * (number + 1))
    return np.diff(sums)


@pytest.mark.parametrize("cutoff", [0.3, 0.1, 0.03])
def test_chance_is_right_on_average(renderer: Renderer, cutoff: float) -> None:
    """64 samples against the same rays followed to the end: the mean is within 3 standard errors, where the two other
    ends miss by dozens of them."""
    errors = {
        end: means_by_sample(renderer, 64, cutoff=cutoff, end=end) - means_by_sample(renderer, 64, cutoff=1e-6)
        for end in ("roulette", "cut")
    }
    by_chance = errors["roulette"]
    assert abs(by_chance.mean()) < 3 * by_chance.std(ddof=1) / 8  # measured 0.7
    assert errors["cut"].mean() < -20 * by_chance.std(ddof=1) / 8


def test_of_the_three_ends_chance_has_the_least_error_and_takes_the_longest(renderer: Renderer) -> None:
    """At a cut-off of 0.1, 16 samples: the mean error is -4.8e-3, -1.1e-3 and 2e-5; the root mean square 0.0106, 0.0080
    and 0.0045; segments in a ratio of 1 : 1 : 1.23."""
    converged = radiance(take(renderer, scene(cutoff=1e-6), samples=16))
    pictures = {end: take(renderer, scene(cutoff=0.1, end=end), samples=16) for end in ("cut", "sky", "roulette")}
    difference = {end: radiance(picture) - converged for end, picture in pictures.items()}
    bias = {end: abs(d.mean()) for end, d in difference.items()}
    error = {end: np.sqrt((d**2).mean()) for end, d in difference.items()}
    assert bias["roulette"] < 2e-4 < bias["sky"] < bias["cut"] < 1e-2
    assert error["roulette"] < error["sky"] < error["cut"] < 0.02
    segments = {end: picture.segments() for end, picture in pictures.items()}
    assert segments["cut"] == segments["sky"] < segments["roulette"] < 1.5 * segments["cut"]


def test_an_end_by_chance_cuts_nothing(renderer: Renderer) -> None:
    picture = take(renderer, scene(cutoff=0.1, end="roulette"))
    assert picture.cut_map().max() == 0
