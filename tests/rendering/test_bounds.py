"""What was cut is worth at most the largest radiance outside, and no place shows more than that."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.rendering.bounds import largest_radiance
from culet.rendering.programs import build
from culet.rendering.renderer import Renderer
from culet.scene import PRESETS
from culet.scene.legacy import legacy
from culet.stage import Stage
from rendering.views import radiance, take

SCENES: dict[str, dict[str, Any]] = {
    "default": {},
    "matte room": {"floor": {"kind": "matte"}, "walls": {"kind": "matte"}},
    "light box": {"environment": {"kind": "image", "scale": 2}, "floor": {"kind": "none"}},
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES.keys())
def test_what_a_coarse_cutoff_loses_is_within_the_bound(exact: Renderer, scene: dict[str, Any]) -> None:
    """Far within it, since few chains end where it is brightest."""
    coarse = take(exact, legacy({**scene, "optics": {"cutoff": 0.1}}))
    fine = take(exact, legacy({**scene, "optics": {"cutoff": 1e-5, "max_bounces": 4096}}))
    missing = float(np.mean(radiance(fine) - radiance(coarse)))
    assert 0 < missing <= coarse.truncation_bound()


def test_what_mirrors_cut_of_a_chain_counts_in_however_many_parts_it_is_followed(
    exact: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two segments at a time, and all in one go. Without what chains that go on have lost, 1.9e-4 were missing."""
    scene = legacy({"optics": {"cutoff": 0.1}})
    in_parts = take(exact, scene).cut_map()
    monkeypatch.setattr(build, "FLAGS", (*build.FLAGS, "-DSTRIDE=256"))
    at_once = take(Renderer(exact.device, lanes=exact.variant.lanes, real=np.float64), scene).cut_map()
    assert in_parts == pytest.approx(at_once, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("name", [name for name, preset in PRESETS.items() if preset.scene.optics.estimator == "chain"])
def test_nothing_is_brighter_than_the_largest_radiance(exact: Renderer, name: str) -> None:
    scene = PRESETS[name].scene
    assert radiance(take(exact, scene)).max() <= largest_radiance(Stage.of(scene)) * (1 + 1e-12)


BRIGHTEST: dict[str, dict[str, Any]] = {
    "a lamp before the sky": {
        "stones": [], "floor": {"kind": "none"}, "environment": {"kind": "constant", "radiance": [2, 2, 2]},
        "emitters": [{"shape": "round", "direction": [0, 0, -1], "radiance": [5, 5, 5], "half_angle_degrees": 20}],
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
    },
    "the report's floor, which is never dark": {
        "stones": [], "floor": {"kind": "matte"}, "environment": {"kind": "constant", "radiance": [0.01, 0.01, 0.01]},
        "emitters": [], "optics": {"estimator": "classic"},
    },
}  # fmt: skip


@pytest.mark.parametrize("scene", BRIGHTEST.values(), ids=BRIGHTEST.keys())
def test_where_nothing_takes_light_away_the_brightest_place_has_the_largest_radiance(
    exact: Renderer, scene: dict[str, Any]
) -> None:
    shown = legacy(scene)
    assert radiance(take(exact, shown)).max() == pytest.approx(largest_radiance(Stage.of(shown)), rel=1e-9)
