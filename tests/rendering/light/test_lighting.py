"""Light maps of pictures: kept while stones and emitters stay, refined in passes, honest about what they miss."""

from __future__ import annotations

import gc
import math
import pickle
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise
from typing import Any
from weakref import ref

import numpy as np
import pyopencl as cl
import pytest
from numpy.typing import NDArray

from culet.errors import DeviceError
from culet.geometry.shape import Shape
from culet.rendering.chains import AUTO_BANDS, CHANNELS
from culet.rendering.emitters import open_sky
from culet.rendering.emitters.light_map import frame_of
from culet.rendering.emitters.panorama_light import is_summed
from culet.rendering.emitters.ray import LightRay
from culet.rendering.emitters.sources import rays_of
from culet.rendering.film.target import Target
from culet.rendering.kernel_inputs.inputs import Inputs
from culet.rendering.light import beams
from culet.rendering.light.beams import Beams
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.illumination import Illumination, Maker
from culet.rendering.light.lighting import Lighting, beams_of
from culet.rendering.light.solids import takes_only_beams
from culet.rendering.opencl.device import Device
from culet.rendering.pace import KernelPace
from culet.rendering.renderer import MIXED, DevicePicture, Renderer
from culet.scene import Scene
from culet.scene.presets import PRESETS, preset
from culet.stage import Stage
from shared.patience import PATIENCE
from shared.stages import staged
from shared.stones import ring

POINT = {"shape": "point", "position": [-4, 6, 4], "colour": [1, 1, 1]}
SUN = {"shape": "sun", "direction": [-4, 6, 4], "colour": [1, 1, 1]}
SIZE = 48, 27


def scene_of(**changes: object) -> Scene:
    bare = {"floor": {"kind": "matte"}, "environment": {"kind": "constant", "radiance": [0, 0, 0]}, "emitters": [POINT]}
    return Scene.read({**bare, **changes})


def lit(renderer: Renderer, stage: Stage, effort: LightEffort, samples: int = 1) -> tuple[DevicePicture, Illumination]:
    picture = renderer.picture(stage, *SIZE, effort=effort)
    picture.refine(samples)
    found = renderer.lighting.of(stage)
    assert found is not None
    return picture, found


def texels(renderer: Renderer, found: Illumination) -> NDArray[np.float32]:
    made = np.empty(found.bound.frame.shape, np.float32)
    cl.enqueue_copy(renderer.device.queue, made, found.bound.buffer)
    return made


def test_an_orbiting_camera_costs_the_map_nothing(renderer: Renderer) -> None:
    scene = scene_of()
    _, before = lit(renderer, Stage.of(scene), LightEffort.MOVING)
    camera = scene.camera.model_copy(update={"position": (3.0, 2.0, 3.0)})
    picture, after = lit(renderer, Stage.of(scene.model_copy(update={"camera": camera})), LightEffort.MOVING)
    assert after is before
    assert after.passes == 1
    assert picture.light_bound() == before.figures.bound if before.figures else False


def test_a_panorama_is_summed_before_a_picture_is_begun(renderer: Renderer) -> None:
    pixels = np.ones((64, 128, 3), np.float32)
    pixels.flags.writeable = False
    stage = staged(scene_of(floor={"kind": "mirror"}), panorama=pixels)
    assert not renderer.is_ready(stage)
    renderer.make_ready(stage)
    assert renderer.is_ready(stage)
    assert is_summed(pixels)


def test_what_a_room_leaves_of_the_sky_is_found_before_its_first_picture_asks(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes 0.3 s, for which the frames of others would wait."""
    stage = Stage.of(Scene.read({"floor": {"kind": "mirror"}, "walls": {"kind": "mirror"}}))
    renderer.make_ready(stage)
    monkeypatch.setattr(open_sky, "_KNOWN", {})
    assert not renderer.is_ready(stage)
    assert renderer.is_ready(Stage.of(Scene.read({"floor": {"kind": "none"}}))), "there is no room"
    other = Stage.of(Scene.read({"floor": {"kind": "mirror"}, "walls": {"kind": "mirror"}, "millimetres": 2}))
    renderer.make_ready(other)
    assert renderer.is_ready(other)
    monkeypatch.setattr(open_sky, "_found", lambda _surfaces: pytest.fail("while a picture is drawn"))
    renderer.picture(other, 32, 18).refine()


def test_pictures_that_are_begun_together_have_their_beams_compiled_once(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten at a time took ten times the memory of a compiler and of a pass."""
    lighting, passes, together = Lighting(renderer.device, renderer.allocate), [], threading.Barrier(4)

    def make(*_given: object, **_how: object) -> None:
        passes.append(1)
        time.sleep(0.02)  # that others may come to it if they can

    def ask() -> None:
        together.wait(PATIENCE)
        lighting.make_ready(Stage.of(scene_of()))
        assert lighting.is_ready(Stage.of(scene_of()))

    monkeypatch.setattr(Beams, "make", make)
    with ThreadPoolExecutor(4) as pool:
        for each in [pool.submit(ask) for _ in range(4)]:
            each.result(PATIENCE)
    assert len(passes) == 1


@pytest.mark.parametrize(
    "changes",
    [
        {"stones": [{"position": [0, 0.5, 0]}]},
        {"stones": [{"material": "ruby"}]},
        {"emitters": [{**POINT, "colour": [1, 1, 0.5]}]},
        {"emitters": [POINT, SUN]},
        {"walls": {"kind": "matte"}},
        {"optics": {"bands": 8}},
        {"optics": {"caustics": "off"}},
    ],
)
def test_what_changes_the_light_needs_another_map(renderer: Renderer, changes: dict[str, Any]) -> None:
    stages = Stage.of(scene_of(stones=[{}])), Stage.of(scene_of(**{"stones": [{}], **changes}))
    assert renderer.lighting.of(stages[0]) is not renderer.lighting.of(stages[1])
    assert renderer.lighting.of(stages[0]) is renderer.lighting.of(Stage.of(stages[0].scene, before=stages[0]))


@pytest.mark.parametrize(
    ("material", "bands"), [({"ior": [1.5, 1.5, 1.5]}, CHANNELS), ("diamond", AUTO_BANDS)], ids=["flat", "dispersive"]
)
def test_open_wavelengths_have_the_map_of_as_many_that_are_asked_for(
    renderer: Renderer, material: object, bands: int
) -> None:
    """A picture at rest leaves them open, and a moving one asks for three: where that is the same light, it is kept."""
    found = {
        asked: renderer.lighting.of(Stage.of(scene_of(stones=[{"material": material}], optics={"bands": asked})))
        for asked in ("auto", CHANNELS, AUTO_BANDS)
    }
    assert found["auto"] is found[bands]
    assert found[CHANNELS] is not found[AUTO_BANDS]


@pytest.mark.parametrize(
    "scene",
    [
        Scene(),
        scene_of(floor={"kind": "mirror"}),
        scene_of(floor={"kind": "none"}),
        scene_of(emitters=[]),
        scene_of(stones=[]),
    ],
    ids=["default", "mirror", "no floor", "no emitters", "no stone"],
)
def test_where_nothing_would_show_it_there_is_no_map_no_code_and_no_time(renderer: Renderer, scene: Scene) -> None:
    stage = Stage.of(scene)
    assert renderer.lighting.of(stage) is None
    picture = renderer.picture(stage, *SIZE)
    picture.refine(2)
    assert picture.light_seconds == 0
    assert math.isnan(picture.light_error())
    assert math.isnan(picture.light_bound())


def test_a_moving_picture_makes_one_pass_at_the_cutoff_of_its_scene(renderer: Renderer) -> None:
    for cutoff in (5e-3, 2e-3):
        stage = Stage.of(scene_of(optics={"caustics_cutoff": cutoff}, stones=[{"position": [0, 0.25, 0]}]))
        _, found = lit(renderer, stage, LightEffort.MOVING)
        assert found.cutoff == cutoff, "a finer one is wanted than there is"
    passes = found.passes
    coarse = Stage.of(scene_of(optics={"caustics_cutoff": 0.1}, stones=[{"position": [0, 0.25, 0]}]))
    assert lit(renderer, coarse, LightEffort.MOVING)[1].passes == passes, "there is a finer one than is wanted"


@pytest.mark.parametrize("emitter", [POINT, SUN], ids=["point", "sun"])
def test_passes_at_rest_come_as_near_as_they_say(renderer: Renderer, device: Device, emitter: dict[str, Any]) -> None:
    """Against a map of 1e-7, of a sun of so many directions that 64 of them make no difference."""
    stage = Stage.of(scene_of(emitters=[emitter], stones=[{"position": [0, 0.125, 0]}]))
    renderer.lighting.of(stage)
    picture, found = lit(renderer, stage, LightEffort.PATIENT)
    assert found.good_enough
    frame = frame_of(stage)
    target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    beams, count = Beams(device), 1 if emitter is POINT else 96
    for number in range(count):
        beams.make(
            stage, rays_of(stage, 1000 + number), frame, target, cutoff=1e-6 if emitter is POINT else 1e-4,
            keep=number / (number + 1), gain=1 / (number + 1),
        )  # fmt: skip
    exact = np.empty(frame.shape, np.float32)
    cl.enqueue_copy(device.queue, exact, target)
    error = math.sqrt(float(np.mean(np.square(texels(renderer, found)[0, 0] - exact[0, 0], dtype=np.float64))))
    print(error, found.rmse, found.passes, found.cutoff, found.seconds, picture.light_error())
    assert error < 2 * found.rmse
    assert found.rmse < 4 * error


def test_an_error_at_rest_falls_and_then_nothing_is_done(renderer: Renderer) -> None:
    stage = Stage.of(scene_of(stones=[{"position": [0, 0.375, 0]}]))
    _, found = lit(renderer, stage, LightEffort.MOVING)
    first, bound = found.rmse, found.figures.bound if found.figures else math.nan
    _, found = lit(renderer, stage, LightEffort.PATIENT)
    assert found.rmse < first / 2
    assert found.figures is not None
    assert found.figures.bound < bound / 2
    passes = found.passes
    picture, found = lit(renderer, stage, LightEffort.PATIENT, 4)
    assert found.passes == passes
    assert picture.light_error() == found.rmse


def test_of_frames_that_move_the_last_map_is_kept_and_of_pictures_at_rest_several(renderer: Renderer) -> None:
    """A map of floor and walls has 24 MiB, and no frame shows the one of a frame before."""
    stages = [Stage.of(scene_of(stones=[{"position": [x, 1, 0]}])) for x in (0.0, 0.1, 0.2)]
    for effort, kept in ((LightEffort.MOVING, [False, False, True]), (LightEffort.RESTING, [True, True, True])):
        renderer.lighting.forget()
        made = [ref(lit(renderer, stage, effort)[1]) for stage in stages]
        gc.collect()
        assert [each() is not None for each in made] == kept
    resting = renderer.lighting.of(stages[0])
    assert resting is made[0]()


def test_of_large_maps_at_rest_only_the_last_is_kept(renderer: Renderer) -> None:
    """One of floor and walls has 24 MiB."""
    walls = {"walls": {"kind": "matte"}}
    stages = [Stage.of(scene_of(stones=[{"position": [x, 1, 0]}], **walls)) for x in (0.0, 0.1, 0.2)]
    renderer.lighting.forget()
    made = [ref(lit(renderer, stage, LightEffort.RESTING)[1]) for stage in stages]
    gc.collect()
    assert [each() is not None for each in made] == [False, False, True]


def test_what_a_moving_picture_reads_is_made_during_the_first_launch_of_its_light(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that the device has something to do meanwhile; the picture is the same as one that had it before."""
    stage = Stage.of(scene_of())
    renderer.lighting.forget()
    before = renderer.picture(stage, *SIZE, effort=LightEffort.MOVING)
    before.prepare()
    before.refine()
    done: list[str] = []
    launch, read = Beams._launch, Inputs.prepare

    def launched(own: Beams, kernel: object, buffers: Sequence[object], begin: int, end: int, *more: int) -> None:
        launch(own, kernel, buffers, begin, end, *more)
        done.append("launch")

    def asked(inputs: Inputs, sample: int, level: int = 0) -> None:
        done.append("read")
        read(inputs, sample, level)

    monkeypatch.setattr(Beams, "_launch", launched)
    monkeypatch.setattr(Inputs, "prepare", asked)
    renderer.lighting.forget()
    picture = renderer.picture(stage, *SIZE, effort=LightEffort.MOVING)
    assert done == [], "nothing is made before its light"
    for _ in picture.refine_in_pieces(1, 1e-3):
        pass
    assert done[:2] == ["launch", "read"]
    assert "launch" in done[2:], "there is more light to come"
    assert (picture.linear() == before.linear()).all()


@pytest.mark.parametrize("waited", [True, False])
def test_a_launch_that_may_have_ended_before_it_was_waited_for_makes_no_pace_slower(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch, *, waited: bool
) -> None:
    """Or what the host makes meanwhile would count, and launches would become ever shorter."""
    stage, own = Stage.of(scene_of()), Beams(renderer.device)
    frame, rays = frame_of(stage), rays_of(stage, 0)
    target = cl.Buffer(renderer.device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    monkeypatch.setattr(beams, "NO_WAIT", 0.0 if waited else math.inf)
    for _ in range(2):
        own._paces.update(dict.fromkeys(own._paces, 1e-9))  # of the second pass: quicker than any launch is
        for _ in own.pieces(stage, rays, frame, lambda: target, cutoff=1e-3, seconds=1.0, meanwhile=lambda: None):
            pass
    assert own._paces
    assert all((pace > 1e-9) == waited for pace in own._paces.values())


def test_passes_of_two_pictures_may_be_under_way_by_turns(renderer: Renderer) -> None:
    """As the painter takes turns: each gets the map that it would get alone."""
    stages = [Stage.of(scene_of(stones=[{"position": [0, height, 0]}])) for height in (0.0625, 0.1875)]
    alone = [texels(renderer, lit(renderer, stage, LightEffort.MOVING)[1]) for stage in stages]
    renderer.lighting.forget()
    under_way = [
        renderer.picture(stage, *SIZE, effort=LightEffort.MOVING).refine_in_pieces(1, 1e-4) for stage in stages
    ]
    while under_way:
        under_way = [each for each in under_way if next(each, None) is not None]
    for stage, wanted in zip(stages, alone, strict=True):
        found = renderer.lighting.of(stage)
        assert found is not None
        assert abs(texels(renderer, found) - wanted).max() < 1e-3


@pytest.mark.parametrize("emitter", [POINT, SUN], ids=["point", "sun"])
def test_a_picture_at_rest_is_the_same_whatever_was_drawn_before(renderer: Renderer, emitter: dict[str, Any]) -> None:
    stage = Stage.of(scene_of(emitters=[emitter]))
    coarse = stage.scene.optics.model_copy(update={"caustics_cutoff": 0.05})
    renderer.lighting.forget()
    fresh, _ = lit(renderer, stage, LightEffort.RESTING, 3)
    again, _ = lit(renderer, stage, LightEffort.RESTING, 3)
    for optics in (stage.scene.optics, coarse):
        renderer.lighting.forget()
        moving, _ = lit(renderer, Stage.of(stage.scene.model_copy(update={"optics": optics})), LightEffort.MOVING)
        after, _ = lit(renderer, stage, LightEffort.RESTING, 3)
        assert after.samples == 3
        assert (after.linear() == fresh.linear()).all(), "by one that was made for a moving picture"
    assert (moving.linear() != fresh.linear()).any()
    renderer.lighting.forget()
    given_up = renderer.picture(stage, *SIZE, effort=LightEffort.RESTING).refine_in_pieces(3, 1e-4)
    for _ in range(30):
        next(given_up)
    del given_up
    resumed, _ = lit(renderer, stage, LightEffort.RESTING, 3)
    assert fresh.samples == again.samples == resumed.samples == 3
    assert (resumed.linear() == fresh.linear()).all(), "by one that was begun for a picture that was given up"
    assert (again.linear() == fresh.linear()).all(), "by a map that is there already"


@pytest.mark.parametrize("size", [SIZE, (150, 110)])
def test_light_at_rest_is_shown_while_it_gets_better_and_ends_in_the_same_picture(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    """Samples and pieces of passes by turns, or all passes at once; of several tiles, amid both. What is seen has ever
    more samples, if only by being sampled anew in the last light, and no more than are needed."""
    many = size != SIZE
    most = 20 if many else 5
    monkeypatch.setattr("culet.rendering.light.illumination.MOST_PASSES", most)
    monkeypatch.setattr("culet.rendering.renderer.LIGHT_FOR_SAMPLES", 0.0)
    stage, target = Stage.of(scene_of(emitters=[SUN])), Target(4)
    renderer.lighting.forget()
    expected = renderer.picture(stage, *size, effort=LightEffort.RESTING)
    for _ in expected.refine_until(target, math.inf):
        pass
    assert expected.samples == expected.samples_seen == 4
    if many:
        monkeypatch.setattr(KernelPace, "steps", lambda _pace, _seconds: 600)
        monkeypatch.setattr("culet.rendering.renderer.SOON", 0.0)
    renderer.lighting.forget()
    picture, looks = renderer.picture(stage, *size, effort=LightEffort.RESTING), [(0, 0, 0)]
    found, mixed = renderer.lighting.of(stage), 0
    assert found is not None

    def due(seconds: float) -> bool:
        """Of several tiles amid samples, and then when there is another pass."""
        return not many or seconds == 0 or found.passes != looks[-1][0]

    while not picture.reached(target):
        for _ in picture.refine_until(target, 1e-3 if many else 1e-5, due=due):
            pass
        looks.append((found.passes, picture.samples, picture.samples_seen))
        mixed += picture.under_way and picture._lit_by == MIXED
    passes, samples, seen = zip(*looks, strict=True)
    assert list(passes) == sorted(passes)
    assert passes[-1] == most
    assert mixed > 0 or not many
    anew = next(number for number, (before, after) in enumerate(pairwise(samples), 1) if after < before)
    assert samples[anew] <= 1, "the light is as good as it gets"
    assert list(seen) == sorted(seen)
    assert passes[2] < most, "the passes went on meanwhile"
    assert seen[anew] > samples[anew]
    assert picture.linear().tobytes() == expected.linear().tobytes()
    renderer.lighting.forget()
    patient = renderer.picture(stage, *size, effort=LightEffort.PATIENT)
    for _ in patient.refine_until(target, 1e-4, due=lambda _: True):
        pass
    assert patient.light_error() == expected.light_error(), "a still waits for all its light"


def test_without_fireflies_a_picture_has_one_sample_in_each_light_until_the_last(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They cannot be told from two lights, and no look has fewer samples than the one before."""
    monkeypatch.setattr("culet.rendering.light.illumination.MOST_PASSES", 5)
    monkeypatch.setattr("culet.rendering.renderer.LIGHT_FOR_SAMPLES", 0.0)
    stage, target = Stage.of(scene_of(emitters=[SUN], film={"fireflies": "hide"})), Target(3)
    renderer.lighting.forget()
    picture, seen = renderer.picture(stage, *SIZE, effort=LightEffort.RESTING), list[int]()
    while not picture.reached(target):
        for _ in picture.refine_until(target, 1e-5, due=lambda _: True):
            pass
        seen.append(picture.samples_seen)
    assert seen[-3:] == [1, 2, 3]
    assert seen == sorted(seen)
    assert len(seen) > 3, "one look in each light"
    expected = renderer.picture(stage, *SIZE, effort=LightEffort.RESTING)
    for _ in expected.refine_until(target, math.inf):
        pass
    assert picture.linear().tobytes() == expected.linear().tobytes()


def test_a_pass_that_another_picture_has_begun_anew_adds_nothing(renderer: Renderer) -> None:
    """Two viewers of one stage: a pass of a moving picture is under way when one at rest begins its own."""
    stage = Stage.of(scene_of())
    coarse = stage.scene.model_copy(update={"optics": stage.scene.optics.model_copy(update={"caustics_cutoff": 0.01})})
    renderer.lighting.forget()
    _, alone = lit(renderer, stage, LightEffort.RESTING)
    wanted = texels(renderer, alone)
    renderer.lighting.forget()
    superseded = renderer.picture(stage.showing(coarse), *SIZE, effort=LightEffort.MOVING).refine_in_pieces(1, 1e-5)
    for _ in range(5):
        next(superseded)
    found = renderer.lighting.of(stage.showing(coarse))
    assert found is not None
    assert found.passes == 0, "a pass is under way"
    resting = found.pieces(stage.scene.optics.caustics_cutoff, LightEffort.RESTING, 1e-5, first=True)
    for _ in range(5):
        next(resting)
    for _ in superseded:
        pass
    for _ in resting:
        pass
    assert found.passes == 1
    assert (texels(renderer, found) == wanted).all()


def test_a_moving_picture_has_light_where_the_pass_that_it_waited_for_is_begun_anew_later(renderer: Renderer) -> None:
    """Three viewers, two of them of one stage: the pass that is begun anew waits for that of the other stage."""
    stage, other = (Stage.of(scene_of(stones=[{"position": [0, height, 0]}])) for height in (1.0, 1.5))
    renderer.lighting.forget()
    _, alone = lit(renderer, stage, LightEffort.MOVING)
    wanted = texels(renderer, alone)
    renderer.lighting.forget()
    first = renderer.picture(other, *SIZE, effort=LightEffort.RESTING).refine_in_pieces(1, 1e-5)
    moving = renderer.picture(stage, *SIZE, effort=LightEffort.MOVING).refine_in_pieces(1, 1e-5)
    resting = renderer.picture(stage, *SIZE, effort=LightEffort.RESTING).refine_in_pieces(1, 1e-5)
    for work in (first, moving, resting):
        next(work)
    for _ in moving:
        pass
    found = renderer.lighting.of(stage)
    assert found is not None
    assert found.passes == 1
    assert (texels(renderer, found) == wanted).all()
    for work in (first, resting):
        for _ in work:
            pass
    assert found.passes == 1
    assert not found.provisional


def test_passes_of_several_pictures_hold_the_memory_of_one_and_make_the_same_maps(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three viewers whose pictures are refined by turns, in small pieces."""
    stages = [Stage.of(scene_of(stones=[{"position": [0, height, 0]}])) for height in (1.0, 1.5, 2.0)]
    wanted = []
    for stage in stages:
        renderer.lighting.forget()
        wanted.append(texels(renderer, lit(renderer, stage, LightEffort.RESTING)[1]))
    renderer.lighting.forget()
    held, most, take, give_back = 0, 0, renderer.lighting.passes.take_beams, renderer.lighting.passes.give_back

    def taken() -> Beams:
        nonlocal held, most
        held += 1
        most = max(most, held)
        return take()

    def given(own: Beams) -> None:
        nonlocal held
        held -= 1
        give_back(own)

    monkeypatch.setattr(renderer.lighting.passes, "take_beams", taken)
    monkeypatch.setattr(renderer.lighting.passes, "give_back", given)
    works = [renderer.picture(stage, *SIZE, effort=LightEffort.RESTING).refine_in_pieces(1, 1e-5) for stage in stages]
    while works:
        works = [work for work in works if next(work, None) is not None]
    assert (most, held) == (1, 0)
    for stage, texels_alone in zip(stages, wanted, strict=True):
        found = renderer.lighting.of(stage)
        assert found is not None
        assert found.passes == 1
        assert (texels(renderer, found) == texels_alone).all()


def test_a_pass_that_nobody_waits_for_is_given_up_for_another_stage(renderer: Renderer) -> None:
    left, wanted = (Stage.of(scene_of(stones=[{"position": [0, height, 0]}])) for height in (1.0, 1.5))
    renderer.lighting.forget()
    given_up = renderer.picture(left, *SIZE, effort=LightEffort.RESTING).refine_in_pieces(1, 1e-5)
    for _ in range(5):
        next(given_up)
    del given_up
    abandoned = renderer.lighting.of(left)
    assert abandoned is not None
    lit(renderer, wanted, LightEffort.RESTING)
    assert abandoned.passes == 0
    lit(renderer, left, LightEffort.RESTING)
    assert abandoned.passes == 1, "and made when it is needed"


def test_a_pass_that_failed_is_made_anew(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    stage, made = Stage.of(scene_of()), Beams.pieces

    def failing(*_: object, **__: object) -> Iterator[None]:
        yield
        raise DeviceError("lost")

    renderer.lighting.forget()
    found = renderer.lighting.of(stage)
    assert found is not None
    monkeypatch.setattr(Beams, "pieces", failing)
    with pytest.raises(DeviceError):
        list(found.pieces(1e-3, LightEffort.RESTING, 1, first=True))
    monkeypatch.setattr(Beams, "pieces", made)
    list(found.pieces(1e-3, LightEffort.RESTING, 1, first=True))
    assert found.passes == 1
    picture = renderer.picture(stage, *SIZE, effort=LightEffort.RESTING)
    picture.refine()
    monkeypatch.setattr(Beams, "pieces", failing)
    with pytest.raises(DeviceError):
        picture.refine()
    monkeypatch.setattr(Beams, "pieces", made)
    assert not found.good_enough
    picture.refine()
    assert found.good_enough, "its light has not ended with the one that failed"


def test_a_moving_pass_takes_the_rays_of_moving_pictures(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def listening(stage: Stage, number: int, *, moving: bool = False) -> list[LightRay]:
        asked.append(moving)
        return rays_of(stage, number, moving=moving)

    monkeypatch.setattr("culet.rendering.light.illumination.rays_of", listening)
    for effort, moving in ((LightEffort.MOVING, True), (LightEffort.RESTING, False)):
        renderer.lighting.forget()
        asked.clear()
        lit(renderer, Stage.of(scene_of()), effort)
        assert asked[-1] == moving


def test_a_moving_picture_of_many_stones_has_few_rays_of_each_wide_lamp() -> None:
    """Each is cast past each stone onto each surface."""
    lamps = [
        {"shape": "round", "direction": [x, 2, 1], "half_angle_degrees": 9, "radiance": [1, 1, 1]} for x in (-1, 0, 1)
    ]
    stones = [{"id": f"stone-{k}", "scale": 0.2, "position": [k - 2, 0, 0]} for k in range(5)]
    many = Stage.of(scene_of(emitters=lamps, stones=stones, walls={"kind": "matte"}))
    one = Stage.of(scene_of(emitters=lamps))
    assert len(rays_of(many, 0)) == 3 * 16
    assert len(rays_of(many, 0, moving=True)) * 5 * 4 <= 1200
    assert len(rays_of(one, 0, moving=True)) == len(rays_of(one, 0)) == 3 * 48, "past one there is time for all"
    light = [np.sum([ray.colour for ray in rays_of(many, 0, moving=moving)], axis=0) for moving in (False, True)]
    assert light[1] == pytest.approx(light[0], rel=1e-9), "of as much light"


def test_a_stone_that_is_not_convex_is_lit_by_photons(renderer: Renderer) -> None:
    stage = staged(scene_of(stones=[{}], optics={"caustics_cutoff": 0.02}), ring())
    picture, found = lit(renderer, stage, LightEffort.RESTING, 2)
    assert found.maker is Maker.PHOTONS
    assert found.figures is not None
    assert 0 < found.figures.bound < 0.3
    assert not picture.shows_shadows_only()
    lit(renderer, stage, LightEffort.PATIENT)
    assert 0 < found.rmse < 0.05


def test_where_photons_would_take_too_long_a_moving_picture_says_that_it_has_shadows_only(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("culet.rendering.light.illumination.MOVING_PHOTON_SECONDS", 1e-9)
    monkeypatch.setattr("culet.rendering.light.illumination.PHOTON_PASSES", 1)
    stage = staged(scene_of(stones=[{"position": [0, 0.2, 0]}]), ring())
    picture, found = lit(renderer, stage, LightEffort.MOVING)
    assert picture.shows_shadows_only()
    assert picture.light_bound() == pytest.approx(1, abs=0.1)
    assert texels(renderer, found).max() < 1e-6
    picture, found = lit(renderer, stage, LightEffort.RESTING)
    assert picture.shows_shadows_only(), "what is there already is soon seen in full"
    picture.refine()
    assert not picture.shows_shadows_only(), "at rest there is time"
    assert texels(renderer, found).max() > 0.05


def test_a_stone_of_triangles_gets_the_light_that_one_of_half_spaces_gets(renderer: Renderer, brilliant: Shape) -> None:
    scene = scene_of(stones=[{}], optics={"caustics_cutoff": 0.02})
    by_beams = lit(renderer, staged(scene, brilliant), LightEffort.PATIENT)[1]
    by_photons = lit(renderer, staged(scene, replace(brilliant, convex=False)), LightEffort.PATIENT)[1]
    assert (by_beams.maker, by_photons.maker) == (Maker.BEAMS, Maker.PHOTONS)
    wide = [
        texels(renderer, found)[0, 1].reshape(64, 8, 64, 8, 3).mean(axis=(1, 3)) for found in (by_beams, by_photons)
    ]
    assert np.sqrt(np.mean((wide[0] - wide[1]) ** 2)) < 0.03 * np.sqrt(np.mean(wide[0] ** 2))


def test_a_process_of_its_own_can_be_given_any_stage() -> None:
    """By which it compiles the programs of that light."""
    for scene in [*(preset(name) for name in PRESETS), scene_of(stones=[{"cut": "heart", "scale": 0.5}])]:
        stage = Stage.of(scene)
        again = pickle.loads(pickle.dumps(stage))  # noqa: S301 - written just here
        assert again.scene == scene
        assert beams_of(again) == beams_of(stage)
        assert takes_only_beams(again) == takes_only_beams(stage)


def test_programs_that_the_cache_does_not_have_are_compiled_by_a_process_of_its_own(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[Stage] = []

    def run_apart(_begins: object, _order: object, data: bytes) -> bool:
        sent.append(pickle.loads(data))  # noqa: S301 - written just before
        return False

    monkeypatch.setattr("culet.rendering.light.lighting.run_apart", run_apart)
    one = Stage.of(scene_of())
    three = Stage.of(scene_of(stones=[{"position": [3 * i, 0, 0]} for i in range(3)]))
    for missing in (False, True):
        monkeypatch.setattr("culet.rendering.light.lighting.lacks", lambda *_program, missing=missing: missing)
        lighting = Lighting(renderer.device, renderer.allocate, apart=True)
        for stage in (one, three, one):
            lighting.make_ready(stage)
            assert lighting.is_ready(stage), "whether that process did it or not"
    assert [stage.scene for stage in sent] == [one.scene, three.scene]
