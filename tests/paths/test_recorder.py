"""What is told of a pixel's light against the picture that the renderer makes of the very same ray."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from conftest import RendererOf
from culet.errors import SceneError
from culet.paths.asked import Pixel, Ray, answered
from culet.paths.recorder import GivenUpError, PathRecorder
from culet.rendering.chains import first_sample
from culet.rendering.features import features_of
from culet.rendering.light.effort import LightEffort
from culet.rendering.opencl.device import Device
from culet.scene import Scene
from culet.scene.presets import preset
from culet.stage import Stage

SIZE = 96, 54
DIAMOND: dict[str, Any] = {"material": "diamond", "position": [0, -0.37, 0]}
SCENES: dict[str, dict[str, Any]] = {
    "default": {},
    "mirror floor": preset("mirror").model_dump(mode="json"),
    "matte floor, lights, caustics": preset("matte").model_dump(mode="json"),
    "mirrors all around, absorption": {
        "stones": [{**DIAMOND, "absorption": [0.02, 0.3, 1]}],
        "floor": {"kind": "mirror"},
        "walls": {"kind": "mirror"},
        "backdrop": {"kind": "none"},
        "optics": {"cutoff": 0.02},
    },
    "from inside, the sky at the end": {
        "stones": [{**DIAMOND, "position": [0, 0, 0]}],
        "camera": {"position": [0.1, 0, 0.1], "target": [0, 0, -1], "fov_degrees": 90},
        "optics": {"cutoff": 0.02, "end": "sky"},
    },
    "wavelengths, polarised": {"stones": [DIAMOND], "optics": {"bands": 8, "polarised": True}},
    "several stones, one of them not convex": {
        "stones": [
            {**DIAMOND, "cut": "heart"},
            {"material": "ruby", "position": [1.2, -0.37, 0.3], "scale": 0.8},
            {"material": "bk7", "position": [-1.2, -0.37, 0]},
        ],
        "floor": {"kind": "mirror"},
    },
}
PIXELS = ((48, 27), (44, 22), (57, 30), (40, 33), (2, 2), (90, 50))


@pytest.fixture(scope="module")
def recorder(device: Device) -> PathRecorder:
    return PathRecorder(device)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES.keys())
def test_the_parts_of_a_pixel_sum_to_what_the_picture_shows(
    recorder: PathRecorder, renderer_of: RendererOf, device: Device, scene: dict[str, Any]
) -> None:
    stage = Stage.of(Scene.read(scene))
    # In what order light is followed that comes back to several stones decides what is cut: here one ray at a time.
    alone = len(stage.scene.stones) > 1 or stage.scene.optics.polarised
    renderer = renderer_of(1 if alone else device.lanes, np.float32)
    needed = features_of(first_sample(stage))
    shared = replace(needed.general, few_mirrors=needed.few_mirrors)  # one program for many scenes
    picture = renderer.picture(first_sample(stage), *SIZE, features=shared, effort=LightEffort.RESTING)
    picture.refine()
    shown, cut = picture.linear().astype(float), picture.cut_map()
    told_lengths = []
    for column, row in PIXELS:
        told = answered(recorder, stage, Pixel(column, row, *SIZE), effort=LightEffort.RESTING)
        scale = max(abs(shown[row, column]).max(), 1e-3)
        np.testing.assert_allclose(told.value, shown[row, column], rtol=0, atol=2e-6 * scale)  # measured: 7e-7
        assert told.cut == pytest.approx(cut[row, column], rel=1e-3, abs=1e-7)
        by_part = np.sum([part.light for part in told.parts], axis=0)
        by_pass = np.sum([each.light for step in told.steps for each in step.passes], axis=0)
        np.testing.assert_allclose(by_part, told.value, rtol=0, atol=1e-6 * scale)  # measured: 3e-7
        np.testing.assert_allclose(by_pass, told.value, rtol=0, atol=1e-6 * scale)
        assert sum(part.share for part in told.parts) == pytest.approx(1, abs=2e-6)
        assert told.left_out == 0
        told_lengths.append(len(told.steps))
    assert max(told_lengths) > 5, "some pixel is of the stone"


def test_light_that_goes_on_by_chance_is_told_as_it_went(recorder: PathRecorder) -> None:
    """Chance is drawn from a weight's last bits: another program may draw otherwise, so only the sum is compared."""
    scene = {"stones": [DIAMOND], "optics": {"cutoff": 0.1, "end": "roulette"}}
    chances = []
    for column, row in PIXELS:
        told = answered(recorder, Stage.of(Scene.read(scene)), Pixel(column, row, *SIZE))
        by_part = np.sum([part.light for part in told.parts], axis=0)
        np.testing.assert_allclose(by_part, told.value, rtol=1e-6)
        chances += [each for step in told.steps if step.kind == "chance" for each in step.passes]
    assert chances
    for each in chances:
        assert each.weight == pytest.approx(0.1)  # what goes on has the cut-off's weight
        assert each.weight_before * each.kept == pytest.approx(each.weight)


def test_no_weight_is_lost_on_the_way(recorder: PathRecorder) -> None:
    """What goes on from a facet, inside and out, is what came there."""
    told = answered(recorder, Stage.of(Scene.read(SCENES["mirror floor"])), Pixel(48, 27, *SIZE))
    checked = 0
    for step in told.steps:
        if step.kind not in ("enters", "meets"):
            continue
        for each in step.passes:
            followers = [
                other.weight_before
                for later in told.steps
                if later.parent == step.number
                for other in later.passes
                if other.chain == each.chain
            ]
            assert sum(followers) == pytest.approx(each.weight, rel=1e-5)  # measured: 3e-7
            checked += 1
    assert checked > 20


def test_light_that_is_totally_reflected_for_ever_ends_with_its_bounces(recorder: PathRecorder) -> None:
    scene = {
        "stones": [{**DIAMOND, "cut": "princess", "position": [0, 0, 0]}],
        "camera": {"position": [0.1, 0, 0.1], "target": [0.11, 0, -1], "fov_degrees": 90},
        "optics": {"max_bounces": 40, "cutoff": 1e-6},
    }
    told = answered(recorder, Stage.of(Scene.read(scene)), Pixel(50, 27, *SIZE))
    last = [step for step in told.steps if step.kind == "ends"]
    assert last
    assert all(step.inside for step in last)
    assert sum(each.cut for step in last for each in step.passes) == pytest.approx(told.cut, rel=1e-5)


def test_a_ray_from_anywhere_is_the_pixel_that_looks_along_it(recorder: PathRecorder) -> None:
    stage = Stage.of(Scene.read({"stones": [DIAMOND], "backdrop": {"kind": "none"}, "head": None}))
    of_pixel = answered(recorder, stage, Pixel(48, 27, *SIZE))
    of_ray = answered(recorder, stage, Ray(of_pixel.origin, of_pixel.direction))
    assert [step.facet for step in of_ray.steps] == [step.facet for step in of_pixel.steps]
    np.testing.assert_allclose(of_ray.value, of_pixel.value, rtol=1e-4)
    assert of_ray.pixel is None


def test_a_ray_past_the_stone_sees_the_sky_alone(recorder: PathRecorder) -> None:
    even = {"environment": {"kind": "constant"}, "backdrop": {"kind": "none"}}
    stage = Stage.of(Scene.read({"stones": [DIAMOND], **even}))
    told = answered(recorder, stage, Ray((0, 5, 5), (0, 1, 0)))
    (step,) = told.steps
    assert step.kind == "sees"
    assert [part.meets for part in step.parts] == ["sky"]
    assert told.value == pytest.approx((1, 1, 1))
    assert step.elevation_degrees == pytest.approx(90)


@pytest.mark.parametrize("stones", [[], [{**DIAMOND, "position": [0, 9, 9]}]], ids=["none", "one out of sight"])
def test_where_no_stone_is_seen_a_ray_lands_on_the_floor(recorder: PathRecorder, stones: list[dict[str, Any]]) -> None:
    camera = {"position": [3, 5, 0.5], "target": [3, 0, 0], "fov_degrees": 10}
    stage = Stage.of(Scene.read({"stones": stones, "camera": camera}))
    told = answered(recorder, stage, Pixel(48, 27, *SIZE))
    (step,) = told.steps
    (each,) = step.passes
    assert step.kind == "lands"
    assert each.chain is None
    assert each.point[1] == pytest.approx(-1, abs=1e-6)  # the floor's height
    along = np.subtract(each.point, told.origin)
    np.testing.assert_allclose(along / np.linalg.norm(along), told.direction, atol=1e-6)
    assert told.origin == pytest.approx(camera["position"])


def test_wavelengths_that_are_asked_for_are_followed_with_their_own_indices(recorder: PathRecorder) -> None:
    stage = Stage.of(Scene.read({"stones": [DIAMOND]}))
    told = answered(recorder, stage, Pixel(48, 27, *SIZE), wavelengths=(656.3, 486.1))
    assert [chain.wavelength for chain in told.chains] == [656.3, 486.1]
    # Peter 1923: n(C) = 2.4103, n(F) = 2.4354, whose difference is diamond's dispersion.
    red, blue = (chain.indices["stone"] for chain in told.chains)
    assert red == pytest.approx(2.4103, abs=5e-4)
    assert blue == pytest.approx(2.4354, abs=5e-4)


def test_light_on_the_floor_that_takes_too_long_is_refused(device: Device) -> None:
    hasty = PathRecorder(device, light_seconds=0)
    with pytest.raises(SceneError, match="caustics_cutoff makes it end sooner"):
        answered(hasty, Stage.of(preset("matte")), Pixel(*PIXELS[0], *SIZE))
    assert answered(hasty, Stage.of(Scene()), Pixel(*PIXELS[0], *SIZE)).steps, "of a scene that needs no such light"


def test_a_pixel_that_nobody_waits_for_any_more_is_given_up_between_launches(recorder: PathRecorder) -> None:
    answers = iter([True, False])
    with pytest.raises(GivenUpError):
        answered(recorder, Stage.of(preset("matte")), Pixel(*PIXELS[0], *SIZE), waited_for=lambda: next(answers))
    assert answered(recorder, Stage.of(Scene()), Pixel(*PIXELS[0], *SIZE)).steps, "the next one is not in its way"


@pytest.mark.parametrize("pixel", [(96, 0), (0, 54), (-1, 0)])
def test_a_pixel_that_is_not_in_the_picture_is_refused(recorder: PathRecorder, pixel: tuple[int, int]) -> None:
    with pytest.raises(SceneError, match="expected x from 0 to 95 and y from 0 to 53"):
        answered(recorder, Stage.of(Scene()), Pixel(*pixel, *SIZE))


def test_a_ray_that_points_nowhere_and_the_classic_estimator_are_refused(recorder: PathRecorder) -> None:
    with pytest.raises(SceneError, match="expected any length but 0"):
        answered(recorder, Stage.of(Scene()), Ray((0, 3, 0), (0, 0, 0)))
    with pytest.raises(SceneError, match="expected chain"):
        answered(recorder, Stage.of(preset("classic")), Pixel(1, 1, *SIZE))


@pytest.mark.parametrize("cached", [False, True])
def test_an_engine_has_a_program_that_the_cache_lacks_made_by_another_process_first(
    device: Device, monkeypatch: pytest.MonkeyPatch, cached: bool
) -> None:
    asked = []
    monkeypatch.setattr("culet.paths.recorder.precompile_path", lambda features, variant: asked.append(features))
    monkeypatch.setattr("culet.paths.program.lacks", lambda cache, program: not cached)
    apart = PathRecorder(device, apart=True)
    for _ in range(2):
        answered(apart, Stage.of(Scene()), Pixel(2, 2, *SIZE))
    assert len(asked) == (0 if cached else 1), "and is made once"
