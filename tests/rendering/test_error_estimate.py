"""What a picture says of its own error, against its distance from one of many more samples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from culet.rendering.renderer import Renderer
from culet.scene import Scene
from rendering.views import BARE, UPRIGHT, radiance, take

SCENES: dict[str, dict[str, Any]] = {
    "default": {},
    "matte floor": {"floor": {"kind": "matte"}},
    "mirrors": {"walls": {"kind": "mirror"}},
    "stone alone": BARE,
    "half-lit": {**BARE, "environment": {"kind": "half"}, "stones": [UPRIGHT]},
    "spectral": {"optics": {"bands": 8}},
    "polarised": {"optics": {"polarised": True}},
    "light box": {"environment": {"kind": "image"}},
    "roulette": {"optics": {"end": "roulette", "cutoff": 0.1}},
    "tent": {"sampling": {"filter": "tent"}},
    "ruby": {"stones": [{"material": "ruby"}], "optics": {"bands": 8}},
}


@pytest.mark.parametrize("settings", SCENES.values(), ids=SCENES.keys())
def test_the_error_estimate_is_within_a_factor_of_two(renderer: Renderer, settings: dict[str, Any]) -> None:
    """At 2 to 4 samples measured 1.01 (default, 2) to 1.52 (mirrors, 4). It errs on the safe side: well spread samples
    are nearer to the truth than half of them are to the other half, by 2.5 at most (48 samples)."""
    scene = Scene.read(settings)
    converged = radiance(take(renderer, scene, samples=192))
    for samples in (2, 3, 4):
        picture = take(renderer, scene, samples=samples)
        error = math.sqrt(((radiance(picture) - converged) ** 2).mean())
        assert error / 2 < picture.error_estimate() < 2 * error


def test_one_sample_says_nothing_of_its_error(renderer: Renderer) -> None:
    assert np.isnan(take(renderer, Scene()).error_estimate())


def test_a_picture_without_edges_has_no_error(renderer: Renderer) -> None:
    scene = Scene.read({**BARE, "stones": [], "environment": {"kind": "constant"}})
    assert take(renderer, scene, samples=4).error_estimate() == 0
