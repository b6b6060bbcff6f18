"""Stones in a tree of triangles under a uniform sky: all light is seen or counted."""

from __future__ import annotations

from typing import Any

import pytest

from culet.geometry.shape import Shape
from culet.rendering.features import Features, Geometry
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
from rendering.views import BARE, UPRIGHT, radiance, take
from shared.stones import brilliant, ring, star

STONES = {"star": star(), "ring": ring(), "brilliant": brilliant()}


def furnace(camera: dict[str, Any], **optics: object) -> Scene:
    return legacy(
        {
            **BARE,
            "environment": {"kind": "constant"},
            "stones": [{**UPRIGHT, "material": {"ior": [1.5, 2.0, 2.42]}}],
            "camera": camera,
            "optics": {"cutoff": 1e-3, "max_bounces": 65536, **optics},
        }
    )


@pytest.mark.parametrize("polarised", [False, True])
@pytest.mark.parametrize("stone", STONES.values(), ids=STONES.keys())
def test_every_pixel_is_one_within_what_was_cut(
    renderer: Renderer, exact: Renderer, stone: Shape, polarised: bool
) -> None:
    camera = {"position": [1.2, 1.4, 1.9], "target": [0, 0, 0], "fov_degrees": 40}
    for used, tolerance in ((renderer, 1e-6), (exact, 1e-12)):
        picture = take(
            used,
            furnace(camera, polarised=polarised),
            stone,
            features=Features(Geometry.MESH, polarised=int(polarised)),
        )
        missing, cut = 1 - radiance(picture).mean(axis=-1), picture.cut_map()
        assert (cut > 0).mean() > 0.1
        assert missing.max() < cut.max() + tolerance
        assert (missing - cut).max() < tolerance
        # Of polarised light up to twice is counted.
        assert (missing - cut / (2 if polarised else 1)).min() > -tolerance
