"""An eightfold stone seen along its axis, under a sky that is the same all round."""

from __future__ import annotations

import math

import pytest

from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from pictures import compared
from rendering.views import BARE, UPRIGHT, Array, radiance, take

SIZE = 180, 180


def down_the_axis(renderer: Renderer, turned_degrees: float) -> Array:
    angle = math.radians(turned_degrees)
    scene = legacy(
        {
            **BARE,
            "stones": [UPRIGHT],
            "environment": {"kind": "gradient"},
            "camera": {
                "position": [0, 3, 0],
                "target": [0, 0, 0],
                "up": [math.sin(angle), 0, -math.cos(angle)],
                "fov_degrees": 40,
            },
        }
    )
    return radiance(take(renderer, scene, size=SIZE))


def test_a_brilliant_is_the_same_when_the_camera_turns_by_an_eighth(renderer: Renderer, exact: Renderer) -> None:
    """But where a ray meets an edge, which the turned one may pass on the other side."""
    for used, rounding, flips in ((renderer, 1e-4, 0.002), (exact, 1e-12, 1e-12)):  # measured 4.0e-4 and none
        picture = down_the_axis(used, 0)
        for degrees in (45, 90, 180):
            difference = abs(down_the_axis(used, degrees) - picture).max(axis=-1)
            assert (difference > rounding).mean() < flips
        assert (abs(down_the_axis(used, 22.5) - picture).max(axis=-1) > 1e-3).mean() > 0.1


def test_a_brilliant_seen_along_its_axis_is_its_own_mirror_image(exact: Renderer) -> None:
    picture = down_the_axis(exact, 0)
    for mirrored in (picture[:, ::-1], picture[::-1], picture.transpose(1, 0, 2)):
        with compared(picture, mirrored):
            assert (abs(picture - mirrored).max(axis=-1) > 1e-10).mean() < 0.002


@pytest.mark.parametrize("kind", ["constant", "gradient"])
def test_a_stone_of_index_one_is_not_there(exact: Renderer, kind: str) -> None:
    base = {**BARE, "environment": {"kind": kind}}
    seen = radiance(take(exact, legacy({**base, "stones": [{"material": {"ior": [1, 1, 1]}}]})))
    without = radiance(take(exact, legacy({**base, "stones": []})))
    with compared(seen, without):
        assert seen == pytest.approx(without, abs=1e-14)
