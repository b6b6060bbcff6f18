"""The filter of pictures of one sample, against a convolution of scipy's, and what it is for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage

from culet.rendering.renderer import DEVELOPED, Renderer
from culet.scene import Scene
from culet.scene.presets import preset
from culet.stage import Stage

WEIGHTS = np.outer([1, 6, 1], [1, 6, 1])


@pytest.mark.parametrize(("height", "width"), [(1, 1), (1, 40), (2, 6), (16, 16), (37, 17), (90, 161)])
def test_every_pixel_is_the_weighted_mean_of_the_pixels_about_it(renderer: Renderer, height: int, width: int) -> None:
    rgb = np.random.default_rng(height).integers(0, 256, (height, width, 3), np.uint8)
    sums = ndimage.convolve(rgb.astype(int), WEIGHTS[..., None], mode="nearest")
    assert (renderer.softening.softened(rgb) == (sums + 32) // 64).all()


@pytest.mark.parametrize("size", [(33, 17), (1024, 513)])  # the second is developed in two pieces
def test_what_is_filtered_on_the_device_is_what_was_developed(renderer: Renderer, size: tuple[int, int]) -> None:
    picture = renderer.picture(Stage.of(Scene(stones=())), *size)
    for _ in range(2):
        picture.refine(1)
        pieces = sum(1 for _ in picture.develop_in_pieces(soft=True))
        assert pieces == -(-size[0] * size[1] // DEVELOPED)
        assert (picture.softened() == renderer.softening.softened(picture.rgb())).all()


@pytest.mark.parametrize("name", ["default", "mirror", "heap"])
def test_one_sample_softened_is_nearer_to_many_than_one_sample_is(renderer: Renderer, name: str) -> None:
    """Measured at 960x540: a root mean square error of 0.74 to 0.77 of what it is without."""
    stage = Stage.of(preset(name))
    picture = renderer.picture(stage, 192, 108)
    picture.refine(1)
    sharp, soft = picture.rgb().astype(float), picture.softened().astype(float)
    assert (picture.rgb() == sharp).all(), "and the picture itself is as it was"
    picture.refine(23)
    errors = [np.sqrt(((shown - picture.rgb()) ** 2).mean()) for shown in (sharp, soft)]
    assert errors[1] < 0.85 * errors[0]
