"""What pictures take of the device's memory, and what is kept of those that are gone."""

from __future__ import annotations

import gc
import weakref

import pytest

from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import KEPT, Renderer
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.presets import preset
from culet.stage import Stage
from rendering.views import take

SIZE = 320, 180
RUN = 16 * SIZE[0] * SIZE[1]
"""Bytes of the sums of one run of samples: four float32 of each pixel."""


@pytest.fixture
def own(renderer: Renderer) -> Renderer:
    """With a pool that nothing else has used."""
    return Renderer(renderer.device)


def test_a_picture_takes_memory_for_a_second_run_of_samples_with_its_second_sample(own: Renderer) -> None:
    picture = take(own, LEGACY_DEFAULT, size=SIZE)
    with_one = own.pool.active_bytes
    picture.refine()
    assert own.pool.active_bytes - with_one == pytest.approx(RUN, rel=0.1)
    picture.refine()
    assert own.pool.active_bytes - with_one == pytest.approx(RUN, rel=0.1)


def test_a_picture_that_nobody_holds_gives_its_memory_back_at_once(own: Renderer) -> None:
    """Without the garbage collector, which comes whenever it likes."""
    gc.disable()
    try:
        picture = take(own, LEGACY_DEFAULT, size=SIZE, samples=2)
        picture.rgb()
        assert own.pool.active_bytes > 2 * RUN
        del picture
        assert own.pool.active_bytes == 0
    finally:
        gc.enable()


def test_a_picture_that_is_given_up_amid_a_sample_gives_its_memory_back_at_once(own: Renderer) -> None:
    gc.disable()
    try:
        picture = own.picture(Stage.of(LEGACY_DEFAULT), *SIZE)
        pieces = picture.refine_in_pieces(1, 1e-9)
        next(pieces)
        assert picture.under_way
        picture.give_up()
        del picture, pieces
        assert own.pool.active_bytes == 0
    finally:
        gc.enable()


def test_pictures_that_change_their_size_with_each_frame_leave_little_behind(own: Renderer) -> None:
    most = 0
    for width in range(640, 320, -16):  # 20 sizes, 40 MB of sums in all
        picture = take(own, LEGACY_DEFAULT, size=(width, width * 9 // 16))
        most = max(most, own.pool.active_bytes)
        assert own.held()["pictures"] <= most + KEPT + own.pool.active_bytes
        del picture
    assert 20 * most > 2 * (2 * most + KEPT), "or this would not be about sizes"


def test_what_a_large_picture_had_is_kept_for_the_next_one(own: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Memory that the system has to clear costs a frame of this size 15 ms."""
    take(own, LEGACY_DEFAULT, size=(2560, 1440))
    kept = own.held()["pictures"]
    assert own.pool.active_bytes == 0
    assert kept > 2 * KEPT
    monkeypatch.setattr(own, "release", lambda: pytest.fail("it was given back"))
    for _ in range(2):
        take(own, LEGACY_DEFAULT, size=(2560, 1440))
    assert own.held()["pictures"] == kept


def test_what_many_pictures_had_is_given_back_when_others_of_other_sizes_come(own: Renderer) -> None:
    many = [take(own, LEGACY_DEFAULT, size=(640, 360)) for _ in range(12)]
    most = own.pool.active_bytes
    many.clear()
    for width in range(640, 320, -16):
        take(own, LEGACY_DEFAULT, size=(width, 400))
    assert own.held()["pictures"] < most, "of which a third would do, and KEPT"


def test_what_is_kept_of_moving_light_is_given_back_when_it_is_asked_for(own: Renderer) -> None:
    gc.disable()
    try:
        picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.MOVING)
        picture.refine()
        assert picture.light_seconds > 0
        del picture
        beams = own.lighting.take_beams()
        kept = weakref.ref(beams)
        own.lighting.give_back(beams)
        del beams
        assert own.pool.active_bytes > 0, "the map, for the next frame"
        assert kept() is not None
        own.release()
        assert own.pool.managed_bytes == 0
        assert kept() is None
    finally:
        gc.enable()
