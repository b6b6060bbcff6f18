"""The estimator `classic` is the report's, as an independent account of its listings draws it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.geometry.load import shape_of
from culet.rendering.renderer import Renderer
from culet.scene import preset
from culet.scene.legacy import legacy
from pictures import compared
from rendering.classic_reference import classic_picture
from rendering.views import radiance, take

SIZE = 64, 36

SCENES: dict[str, dict[str, Any]] = {
    "falling over a mirror": {},
    "mirror room": {"walls": {"kind": "mirror"}},
    "matte room, light sky": {
        "floor": {"kind": "matte"},
        "walls": {"kind": "matte"},
        "environment": {"kind": "light"},
    },
    "tinted, sky only": {"floor": {"kind": "none"}, "absorption": [2, 1, 0.1]},
}


@pytest.mark.parametrize("name", SCENES)
def test_the_classic_estimator_draws_what_the_report_describes(exact: Renderer, name: str) -> None:
    """Measured: at most 1e-9, which is the epsilon, in every pixel, so no ray takes another facet at an edge."""
    changes = {"optics": {"estimator": "classic", "fresnel": "schlick", "max_bounces": 12}, **SCENES[name]}
    data = preset("report-fig1").model_dump(mode="json")
    stone = {**data["stones"][0], "orientation": [0.9, 0.3, 0.1, 0.2]}
    stone["absorption"] = changes.pop("absorption", stone["absorption"])
    scene = legacy({**data, **changes, "stones": [stone]})
    ours = radiance(take(exact, scene, size=SIZE))
    theirs = classic_picture(scene, shape_of(scene.stones[0], {}), *SIZE)
    with compared(ours, theirs):
        assert np.abs(ours - theirs).max() < 1e-7
    assert theirs.std() > 0.01
