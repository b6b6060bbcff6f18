"""Pictures are refined sample by sample, and the same picture twice is the same to the last bit."""

from __future__ import annotations

import math
from dataclasses import replace
from time import process_time
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from numpy.typing import NDArray

from culet.geometry.load import shape_of
from culet.rendering.film.target import Target
from culet.rendering.light.effort import LightEffort
from culet.rendering.pace import KernelPace
from culet.rendering.renderer import Renderer, jitter
from culet.scene.legacy import LEGACY_DEFAULT, legacy
from culet.stage import Stage
from pictures import compared
from rendering.views import radiance, take
from shared.stages import staged

SCENE = LEGACY_DEFAULT


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


KINDS: dict[str, dict[str, Any]] = {
    "default": {},
    "mirrors": {"walls": {"kind": "mirror"}, "floor": {"kind": "mirror"}},
    "wavelengths": {"optics": {"bands": 8, "polarised": True}},
    "roulette": {"optics": {"end": "roulette"}},
    "classic": {"optics": {"estimator": "classic"}},
    "inside": {"camera": {"position": [0, 0.3, 0.2], "target": [0, 0, 0]}},
    "empty": {"stones": []},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("steps", [1, 37, 1000])
def test_pieces_make_the_same_picture_to_the_last_bit(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch, kind: str, steps: int
) -> None:
    """A launch may end anywhere: among the pixels that are looked at, or in the middle of a chain."""
    scene = legacy(KINDS[kind])
    size = (20, 18) if steps == 1 else (70, 50)  # six tiles, some of them not full
    whole = take(renderer, scene, size=size, samples=2)
    pieced = renderer.picture(Stage.of(scene), *size)
    monkeypatch.setattr(KernelPace, "steps", lambda _pace, _seconds: steps)
    progress = list(pieced.refine_in_pieces(2, 1.0))
    assert pieced.linear().tobytes() == whole.linear().tobytes()
    assert pieced.cut_map().tobytes() == whole.cut_map().tobytes()
    assert pieced.segments() == whole.segments()
    assert progress == sorted(progress)
    assert progress[-1] == 1
    assert len(progress) > 2


def test_a_launch_of_a_very_dear_scene_ends_when_its_steps_are_made(renderer: Renderer) -> None:
    """One pixel's chains of 65536 reflections, between mirrors: a sample takes thousands of launches of 50 steps."""
    scene = legacy(
        {
            "optics": {"bands": 64, "polarised": True, "cutoff": 1e-9, "max_bounces": 65536},
            "walls": {"kind": "mirror"}, "floor": {"kind": "mirror"}, "stones": [{"material": {"ior": [10, 10, 10]}}],
        }
    )  # fmt: skip
    picture = renderer.picture(Stage.of(scene), 1, 1)
    before, launches = process_time(), []
    pieces = picture.refine_in_pieces(1, 1e-9)
    for _ in zip(pieces, range(200), strict=False):
        launches.append(process_time() - before)
        before = process_time()
    assert len(launches) == 200, "a single launch would have been the whole sample"
    assert picture.samples == 0
    assert np.median(launches) < 0.01, "s of processor time, measured 0.0002; the sample takes seconds"


@pytest.mark.parametrize("samples", [0, 1, 2, 3])
def test_a_picture_is_seen_amid_a_sample_where_that_is_done(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch, samples: int
) -> None:
    """Elsewhere it is what was seen before; and it ends as if nobody had looked."""
    size, stage, target = (150, 110), Stage.of(SCENE), Target(5)
    expected = renderer.picture(stage, *size, effort=LightEffort.RESTING)
    for _ in expected.refine_until(target, math.inf):
        if expected.samples == samples + 1 and not expected.under_way:
            break
    whole = expected.softened() if samples == 0 else expected.rgb()
    picture = renderer.picture(stage, *size, effort=LightEffort.RESTING)
    if samples > 0:
        for _ in picture.refine_until(Target(samples), math.inf):
            pass
    monkeypatch.setattr(KernelPace, "steps", lambda _pace, _seconds: 300)
    monkeypatch.setattr("culet.rendering.renderer.SOON", 0.0)
    over = np.full((*size[::-1], 3), 77, np.uint8)
    seen, looks = over, 0
    while picture.samples == samples:
        for _ in picture.refine_until(Target(samples + 1), 1.0, due=lambda _: True):
            pass
        if not picture.under_way:
            break
        assert picture.samples == samples
        assert picture.samples_seen == max(samples, 1)
        before = seen
        *_, seen = picture.overlaid(before)
        same_as_whole = (seen == whole).all(axis=2)
        inside = np.ones_like(same_as_whole) if samples else _away_from_tiles(size, 48)
        assert (same_as_whole | (seen == before).all(axis=2))[inside].all()
        looks += 1
    assert looks > 2
    assert 0 < (seen != over).any(axis=2).mean() < 1
    for _ in picture.refine_until(target, 1.0):
        pass
    at_once = renderer.picture(stage, *size, effort=LightEffort.RESTING)
    for _ in at_once.refine_until(target, math.inf):
        pass
    assert picture.samples == 5
    assert picture.linear().tobytes() == at_once.linear().tobytes()
    assert picture.rgb().tobytes() == at_once.rgb().tobytes()
    assert (picture.cut(), picture.shown_error()) == (at_once.cut(), at_once.shown_error())


def test_a_picture_is_left_after_a_sample_if_the_next_one_would_not_be_whole_in_time(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or that sample would not be seen until the next but one is whole."""
    monkeypatch.setattr("culet.rendering.renderer.SOON", 0.0)
    picture = renderer.picture(Stage.of(SCENE), 48, 27, effort=LightEffort.RESTING)
    for _ in picture.refine_until(Target(3), math.inf, due=lambda seconds: seconds > 0):
        pass
    assert (picture.samples, picture.under_way) == (1, False)


def test_a_tile_that_is_dealt_is_not_done_and_says_nothing_yet(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A picture of one tile, where there was another picture's."""
    picture = renderer.picture(Stage.of(SCENE), 40, 30, effort=LightEffort.RESTING)
    size = picture._tallies_before.nbytes
    cl.enqueue_fill_buffer(renderer.device.queue, picture._tallies, np.full(1, 9, np.float32), 0, size)
    monkeypatch.setattr(KernelPace, "steps", lambda _pace, _seconds: 20)
    for part in picture.refine_until(Target(1), 1.0, due=lambda _: True):
        assert part == 0
    assert picture.under_way
    assert (picture.cut(), picture.segments()) == (0, 0)


def _away_from_tiles(size: tuple[int, int], tile: int) -> NDArray[np.bool_]:
    """Where softening sees only pixels of the same tile."""
    x, y = (np.arange(length) % tile for length in size)
    return np.logical_and.outer((y > 0) & (y < tile - 1), (x > 0) & (x < tile - 1))


def test_refining_in_steps_is_refining_at_once(exact: Renderer) -> None:
    stone = shape_of(SCENE.stones[0], {})
    picture = exact.picture(staged(SCENE, stone), 48, 27)
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
    scene = legacy({"environment": {"kind": "light"}, "floor": {"kind": "none"}, "stones": []})
    picture = take(exact, scene, size=size)
    assert radiance(picture) == pytest.approx(np.broadcast_to((0.7, 0.85, 1), (size[1], size[0], 3)), abs=1e-12)
    assert picture.rgb().shape == (size[1], size[0], 3)
