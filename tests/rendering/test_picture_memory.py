"""What pictures take of the device's memory, and what is kept of those that are gone."""

from __future__ import annotations

import gc
import math
import weakref

import pytest

from culet.rendering import renderer as renderer_module
from culet.rendering.emitters.light_map import frame_of
from culet.rendering.light import passes
from culet.rendering.light.beams import Beams
from culet.rendering.light.effort import LightEffort
from culet.rendering.renderer import KEPT, Renderer
from culet.scene import Scene
from culet.scene.legacy import LEGACY_DEFAULT
from culet.scene.presets import preset
from culet.stage import Stage
from rendering.views import take

SIZE = 320, 180
LIT = Scene.read({"floor": {"kind": "matte"}, "stones": [{}]})
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
    monkeypatch.setattr(renderer_module, "LATELY", math.inf)
    take(own, LEGACY_DEFAULT, size=(2560, 1440))
    kept = own.held()["pictures"]
    assert own.pool.active_bytes == 0
    assert kept > 2 * KEPT
    monkeypatch.setattr(own, "release", lambda: pytest.fail("it was given back"))
    for _ in range(2):
        take(own, LEGACY_DEFAULT, size=(2560, 1440))
    assert own.held()["pictures"] == kept


def test_what_a_large_picture_had_is_given_back_when_only_small_ones_have_come_for_a_while(
    own: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    take(own, LEGACY_DEFAULT, size=(2560, 1440))
    kept = own.held()["pictures"]
    monkeypatch.setattr(renderer_module, "LATELY", math.inf)
    for _ in range(3):
        take(own, LEGACY_DEFAULT, size=SIZE)
    assert own.held()["pictures"] >= kept, "a large one may have come a moment ago"
    monkeypatch.setattr(renderer_module, "LATELY", 0.0)
    take(own, LEGACY_DEFAULT, size=SIZE)
    assert own.held()["pictures"] < KEPT


def test_what_many_pictures_had_is_given_back_when_others_of_other_sizes_come(own: Renderer) -> None:
    many = [take(own, LEGACY_DEFAULT, size=(640, 360)) for _ in range(12)]
    most = own.pool.active_bytes
    many.clear()
    for width in range(640, 320, -16):
        take(own, LEGACY_DEFAULT, size=(width, 400))
    assert own.held()["pictures"] < most, "of which a third would do, and KEPT"


def test_a_light_map_has_memory_from_when_its_light_is_summed(own: Renderer) -> None:
    picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.MOVING)
    size = frame_of(picture.stage).nbytes
    held = []
    for _ in picture.refine_in_pieces(1, 1e-4):
        light_is_there = picture.sample_seconds > 0 or picture.under_way
        held.append((light_is_there, own.pool.active_bytes >= size))
    assert (False, False) in held, "the light takes several launches"
    assert own.pool.active_bytes >= size
    assert all(there == has for there, has in held)


def test_a_resting_pass_that_nobody_waits_for_gives_its_memory_back(
    own: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When another picture is begun a while later; whether or not that one has light."""
    taken: list[weakref.ref[Beams]] = []
    take = own.lighting.passes.take_beams

    def noted() -> Beams:
        beams = take()
        taken.append(weakref.ref(beams))
        return beams

    monkeypatch.setattr(own.lighting.passes, "take_beams", noted)
    other = Stage.of(Scene.read({"floor": {"kind": "matte"}, "emitters": []}))
    for left_seconds in (math.inf, 0.0):
        monkeypatch.setattr(passes, "LEFT_SECONDS", math.inf)
        picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.RESTING)
        under_way = picture.refine_in_pieces(1, 1e-5)
        next(under_way)
        monkeypatch.setattr(passes, "LEFT_SECONDS", left_seconds)
        own.picture(other, 32, 18)
        assert taken[-1]() is not None, "somebody waits for it"
        del under_way
        picture.give_up()
        own.picture(other, 32, 18)
        assert (taken[-1]() is None) == (left_seconds == 0), "or the next picture of the stage goes on with it"
    assert len(taken) == 1


def test_what_a_picture_at_rest_sums_its_light_in_is_given_back_when_that_is_good_enough(own: Renderer) -> None:
    picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.MOVING)
    picture.refine()
    beams = own.lighting.passes.take_beams()
    kept = weakref.ref(beams)
    own.lighting.passes.give_back(beams)
    del beams
    assert kept() is not None, "for the next frame that moves"
    picture = own.picture(Stage.of(LIT), 32, 18, effort=LightEffort.RESTING)
    picture.refine()
    assert kept() is not None, "or its own next pass"
    picture.refine()
    assert picture.light_error() > 0
    assert kept() is None


def test_an_engine_that_draws_nothing_has_no_pass_under_way(own: Renderer) -> None:
    picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.RESTING)
    next(picture.refine_in_pieces(1, 1e-5))
    picture.give_up()
    left = weakref.ref(own.lighting.of(picture.stage) or pytest.fail("no light"))
    del picture
    own.release()
    own.lighting.forget()
    assert left() is None
    assert own.pool.managed_bytes == 0


def test_room_is_made_beside_a_pass_which_another_thread_may_be_in_the_midst_of(own: Renderer) -> None:
    picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.RESTING)
    next(picture.refine_in_pieces(1, 1e-5))
    picture.give_up()
    left = weakref.ref(own.lighting.of(picture.stage) or pytest.fail("no light"))
    del picture
    own.trim()
    own.lighting.forget()
    assert left() is not None, "whoever refines pictures gives it up"
    assert own.pool.managed_bytes == own.pool.active_bytes
    own.release()
    assert left() is None


def test_what_is_kept_of_moving_light_is_given_back_when_it_is_asked_for(own: Renderer) -> None:
    gc.disable()
    try:
        picture = own.picture(Stage.of(preset("heap")), 32, 18, effort=LightEffort.MOVING)
        picture.refine()
        assert picture.light_seconds > 0
        del picture
        beams = own.lighting.passes.take_beams()
        kept = weakref.ref(beams)
        own.lighting.passes.give_back(beams)
        del beams
        assert own.pool.active_bytes > 0, "the map, for the next frame"
        assert kept() is not None
        own.release()
        assert own.pool.managed_bytes == 0
        assert kept() is None
    finally:
        gc.enable()
