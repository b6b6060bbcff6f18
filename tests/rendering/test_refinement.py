"""Pictures are refined sample by sample, and the same picture twice is the same to the last bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from culet.geometry.load import stone_of
from culet.rendering.renderer import Renderer, jitter
from culet.scene import Scene
from pictures import compared
from rendering.views import radiance, take

SCENE = Scene()


def test_the_same_picture_twice_is_the_same_to_the_last_bit(renderer: Renderer) -> None:
    first, second = (take(renderer, SCENE, samples=3) for _ in range(2))
    with compared(first.linear(), second.linear()):
        assert first.linear().tobytes() == second.linear().tobytes()
    assert first.cut_map().tobytes() == second.cut_map().tobytes()
    assert first.rgb().tobytes() == second.rgb().tobytes()
    assert first.segments() == second.segments()


@pytest.mark.parametrize("units", [1, 3, 64])
def test_every_tile_is_dealt_once_however_many_cores_there_are(renderer: Renderer, units: int) -> None:
    """Nine tiles to one work-item, to a few, and to more than there are tiles; launch after launch."""
    size = (70, 90)
    expected = take(renderer, SCENE, size=size, samples=3)
    picture = take(Renderer(replace(renderer.device, units=units)), SCENE, size=size, samples=3)
    with compared(picture.linear(), expected.linear()):
        assert picture.linear().tobytes() == expected.linear().tobytes()
    assert picture.segments() == expected.segments()


@pytest.mark.parametrize("rows", [1, 32, 40, 64])
def test_bands_of_rows_make_the_whole_picture(renderer: Renderer, rows: int) -> None:
    """A band is a whole number of tiles high; the last one may be lower."""
    size = (70, 90)  # three tiles by three, none of the last ones full
    whole = take(renderer, SCENE, size=size, samples=2)
    banded = renderer.picture(SCENE, stone_of(SCENE.stones[0], {}), *size)
    progress = list(banded.refine_in_bands(2, rows))
    with compared(banded.linear(), whole.linear()):
        assert banded.linear().tobytes() == whole.linear().tobytes()
    assert progress == sorted(progress)
    assert progress[-1] == 1
    assert len(progress) == 2 * {1: 3, 32: 3, 40: 2, 64: 2}[rows]


def test_refining_in_steps_is_refining_at_once(exact: Renderer) -> None:
    stone = stone_of(SCENE.stones[0], {})
    picture = exact.picture(SCENE, stone, 48, 27)
    means = []
    for _ in range(4):
        picture.refine()
        means.append(radiance(picture))
    assert picture.samples == 4
    assert radiance(take(exact, SCENE, size=(48, 27), samples=4)).tobytes() == means[-1].tobytes()
    single = [means[0], *(n * means[n - 1] - (n - 1) * means[n - 2] for n in (2, 3, 4))]
    assert min(sample.min() for sample in single) > -1e-14  # each is a picture of its own
    assert abs(single[0] - single[1]).max() > 0.1  # of other rays: edges are smoothed


def test_samples_fill_the_pixel_evenly() -> None:
    """The centre first; of any 64 samples every quarter of a pixel has its 16, give or take 2."""
    assert jitter(0) == (0.5, 0.5)
    points = np.array([jitter(sample) for sample in range(64)])
    assert points.min() >= 0
    assert points.max() < 1
    quarters = (points >= 0.5) @ (1, 2)
    assert abs(np.bincount(quarters, minlength=4) - 16).max() <= 2


def test_refinement_converges_on_the_picture_of_a_finer_grid(exact: Renderer) -> None:
    """The mean of 64 samples is the mean of 8 x 8 pixels at their centres, up to what either misses of the edges."""
    sampled = radiance(take(exact, SCENE, size=(24, 14), samples=64))
    fine = radiance(take(exact, SCENE, size=(192, 112))).reshape(14, 8, 24, 8, 3).mean(axis=(1, 3))
    one = radiance(take(exact, SCENE, size=(24, 14)))
    error, before = np.sqrt(((sampled - fine) ** 2).mean()), np.sqrt(((one - fine) ** 2).mean())
    assert error < before / 4


@pytest.mark.parametrize("size", [(1, 1), (1, 100), (100, 1), (33, 31), (64, 64)])
def test_every_size_is_the_same_picture_as_its_neighbours(exact: Renderer, size: tuple[int, int]) -> None:
    """Tiles that hang over the picture's edge: as bright, finite, and every pixel written."""
    scene = Scene.read({"environment": {"kind": "light"}, "floor": {"kind": "none"}, "stones": []})
    picture = take(exact, scene, size=size)
    assert radiance(picture) == pytest.approx(np.broadcast_to((0.7, 0.85, 1), (size[1], size[0], 3)), abs=1e-12)
    assert picture.rgb().shape == (size[1], size[0], 3)
