"""A sky given as a panorama, against the same sky in closed form, at poles and seam too."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.optics.panoramas import Panorama, directions
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.stage import Stage
from pictures import compared
from rendering.views import BARE, Array, pixel_directions, radiance
from shared.stages import staged

LOOKS: dict[str, dict[str, Any]] = {
    "zenith": {"target": [0, 1, 0], "up": [0, 0, 1]},
    "nadir": {"target": [0, -1, 0], "up": [0, 0, 1]},
    "seam": {"target": [0, 0, -1]},
    "away from the seam": {"target": [0, 0.2, 1]},
}
LOOK = pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS.keys())


def sky_scene(look: dict[str, Any], fov: float, **environment: object) -> Scene:
    camera = {"position": [0, 0, 0], "fov_degrees": fov, **look}
    return legacy({**BARE, "stones": [], "environment": environment, "camera": camera})


def looked_up(renderer: Renderer, scene: Scene, panorama: Panorama) -> Array:
    picture = renderer.picture(staged(scene, panorama=panorama), 64, 64)
    picture.refine()
    return radiance(picture)


def affine(d: Array) -> Array:
    """A different slope in each channel: red by height, green by x, blue by z; from 0 to 1."""
    return np.stack([1 + d[..., 1], 1 + d[..., 0], 1 + d[..., 2]], axis=-1) / 2


@LOOK
@pytest.mark.parametrize(("height", "tolerance"), [(64, 4e-4), (512, 7e-6)])
def test_a_smooth_sky_is_looked_up_to_the_square_of_its_pixels(
    renderer: Renderer, look: dict[str, Any], height: int, tolerance: float
) -> None:
    """Bilinear interpolation of a sine misses pitch^2 / 16 x 2 at most: 3.0e-4 and 4.7e-6."""
    scene = sky_scene(look, 100, kind="image")
    seen = looked_up(renderer, scene, affine(directions(height)).astype(np.float32))
    assert seen == pytest.approx(affine(pixel_directions(scene, 64, 64)), abs=tolerance)


@LOOK
def test_a_panorama_of_the_gradient_is_the_gradient(renderer: Renderer, look: dict[str, Any]) -> None:
    panorama = np.repeat((1 + directions(512)[..., 1:2]) / 2, 3, axis=-1).astype(np.float32)
    seen = looked_up(renderer, sky_scene(look, 120, kind="image"), panorama)
    picture = renderer.picture(Stage.of(sky_scene(look, 120, kind="gradient")), 64, 64)
    picture.refine()
    with compared(seen, radiance(picture)):
        assert seen == pytest.approx(radiance(picture), abs=4e-6)


@LOOK
def test_noise_is_continuous_across_poles_and_seam(exact: Renderer, look: dict[str, Any]) -> None:
    """Neighbouring rays a ten thousandth of a pixel apart, where rows and columns meet round the corner."""
    panorama = np.random.default_rng(2).random((16, 32, 3)).astype(np.float32)
    scene = sky_scene(look, 0.01, kind="image")
    seen = looked_up(exact, scene, panorama)
    # At the pole itself the azimuth jumps: the mean of a row's two halves depends on it, and on nothing else.
    steps = max(abs(np.diff(seen, axis=axis)).max() for axis in (0, 1))
    if look["target"][1] in (1, -1):
        pole = panorama[0 if look["target"][1] == 1 else -1].astype(float)
        means = (pole + np.roll(pole, 16, axis=0)) / 2
        assert seen.min() > means.min() - 1e-3
        assert seen.max() < means.max() + 1e-3
    else:
        assert steps < 1e-4


def test_a_turned_panorama_is_the_panorama_turned(exact: Renderer) -> None:
    panorama = np.random.default_rng(2).random((16, 32, 3)).astype(np.float32)
    look = LOOKS["seam"]
    turned = looked_up(exact, sky_scene(look, 80, kind="image", turn_degrees=90), panorama)
    rolled = looked_up(exact, sky_scene(look, 80, kind="image"), np.roll(panorama, 8, axis=1))
    with compared(turned, rolled):
        assert turned == pytest.approx(rolled, abs=1e-12)
