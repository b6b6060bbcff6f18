"""Stones that no ray of the camera can tell of are left out of the picture, and no others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from culet.rendering.features import features_of
from culet.rendering.kernel_inputs import inputs
from culet.rendering.kernel_inputs.footprint import MOST_TILT, out_of_sight
from culet.rendering.projection import project
from culet.rendering.renderer import Renderer
from culet.rendering.stones.placed_stone import placed_stones
from culet.scene import Scene
from culet.scene.backdrop import PlainBackdrop
from culet.scene.camera import Camera
from culet.scene.emitters import PointLight
from culet.scene.room import Plane, StudioFloor
from culet.scene.stone import StoneSettings
from culet.stage import NOTHING, Library, Stage
from culet.study.bench.cases import RING, ring
from rendering.views import Array, radiance

SIZE = 48, 27
STONES = tuple(
    StoneSettings(id=f"stone-{number}", position=(2.0 * number, 0.5 - number, 1.0), scale=0.7) for number in range(2)
)
BARE = Plane(kind="none")
AWAY = Camera(position=(0, 0, 30), target=(0, 0, 60))


def floor(roughness: float) -> StudioFloor:
    return StudioFloor(kind="studio", reflectance=0.9, fade=50, roughness=roughness, shadow=0.9)


def seen_from(camera: Camera, library: Library = NOTHING, **changes: Any) -> Stage:  # noqa: ANN401 - whatever fields a scene has
    """Two stones, one of them above the floor, before a backdrop that shows every shade."""
    white = PlainBackdrop(kind="plain", colour=(1, 1, 1))
    scene = {"stones": STONES, "camera": camera, "floor": floor(0.02), "backdrop": white, **changes}
    return Stage.of(Scene().model_copy(update=scene), library)


def stages(count: int) -> Iterator[Stage]:
    """Seen from anywhere near, to anywhere, over floors from smooth to the roughest."""
    random = np.random.default_rng(11)
    for _ in range(count):
        x, y, z = random.uniform([-15, -0.8, -15], [15, 6, 15])
        across, up, along = random.normal(size=3) * [1, 0.4, 1]
        yield seen_from(
            Camera(
                position=(x, y, z), target=(x + across, y + up, z + along), fov_degrees=float(random.uniform(10, 40))
            ),
            floor=floor(MOST_TILT * float(random.uniform()) ** 3),
        )


def hidden(stage: Stage) -> bool:
    scene, stones = stage.scene, placed_stones(stage)
    return out_of_sight(scene, stones, project(scene, stones, *SIZE), features_of(stage), *SIZE)


def taken(renderer: Renderer, stage: Stage) -> Array:
    picture = renderer.picture(stage, *SIZE)
    picture.refine(3)  # from the second sample on the floor is tilted
    return radiance(picture)


def test_a_picture_has_the_same_bits_without_stones_that_are_out_of_sight(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    all_stages = list(stages(400))
    left_out = [stage for stage in all_stages if hidden(stage)]
    assert 100 < len(left_out) < len(all_stages) - 100
    without = [taken(renderer, stage) for stage in left_out]
    monkeypatch.setattr(inputs, "out_of_sight", lambda *_: False)
    for stage, picture in zip(left_out, without, strict=True):
        np.testing.assert_array_equal(taken(renderer, replace(stage)), picture)


@pytest.mark.parametrize(
    ("camera", "because"),
    [
        (Camera(position=(0, 3, 6), target=(0, -1.5, 1), fov_degrees=12), "it is mirrored in the floor"),
        (Camera(position=(4, 3, 1), target=(4, -1, 1.01), fov_degrees=20), "it shades the floor"),
    ],
)
def test_a_stone_that_the_floor_tells_of_is_in_sight(camera: Camera, because: str) -> None:
    assert hidden(seen_from(camera, floor=BARE)), "the camera does not see it itself"
    assert not hidden(seen_from(camera)), because


def test_stones_stay_where_mirrors_shadows_or_a_rough_floor_may_tell_of_them() -> None:
    lamp = PointLight(shape="point", position=(0, 5, 30), colour=(1, 1, 1))
    matte = Plane(kind="matte")
    assert hidden(seen_from(AWAY))
    assert hidden(seen_from(AWAY, floor=matte, emitters=()))
    assert not hidden(seen_from(AWAY, floor=matte, emitters=(lamp,)))
    assert not hidden(seen_from(AWAY, floor=Plane(kind="mirror")))
    assert not hidden(seen_from(AWAY, walls=Plane(kind="mirror")))
    assert not hidden(seen_from(AWAY, floor=floor(2 * MOST_TILT)))


def test_one_stone_in_sight_keeps_all() -> None:
    camera = Camera(position=(0, 0.5, 6), target=(0, 0.5, 1), fov_degrees=5)
    assert hidden(seen_from(camera, stones=STONES[1:], floor=BARE))
    assert not hidden(seen_from(camera, floor=BARE))


def test_stones_of_triangles_are_left_out_as_well(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    meshes = tuple(stone.model_copy(update={"mesh": RING}) for stone in STONES)
    stage = seen_from(AWAY, Library({RING: ring()}), stones=meshes)
    assert hidden(stage)
    without = taken(renderer, stage)
    monkeypatch.setattr(inputs, "out_of_sight", lambda *_: False)
    np.testing.assert_array_equal(taken(renderer, replace(stage)), without)
