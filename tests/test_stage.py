"""A stage resolves what its scene names, says which uploads that are, and varies without being resolved again."""

from __future__ import annotations

import numpy as np
import pytest

from culet.errors import MeshError, SceneError
from culet.optics.panoramas import light_box
from culet.optics.sky_files.picture import SkyPicture
from culet.scene import Scene
from culet.scene.sky import DarkEnvironment
from culet.stage import Library, Sky, Stage, uploads_of
from shared.stones import brilliant, tetrahedron

SUNSET = SkyPicture(np.full((2, 4, 3), 0.5, np.float32))
UPLOADS = Library({"m1": tetrahedron()}, {"s1": SUNSET})
NAMING = Scene.read({"stones": [{"mesh": "m1"}], "environment": {"kind": "image", "image": "s1"}})


def test_a_stage_has_a_shape_for_each_stone_and_the_picture_of_its_sky() -> None:
    stage = Stage.of(NAMING, UPLOADS)
    assert stage.shapes == (UPLOADS.meshes["m1"],)
    assert stage.panorama is SUNSET.pixels
    assert Stage.of(Scene()).shapes == (brilliant(),)
    assert Stage.of(Scene(stones=())).shapes == ()


def test_a_sky_that_is_no_image_has_no_picture_and_the_studios_own_need_no_upload() -> None:
    assert Stage.of(Scene()).panorama is None
    own = Stage.of(Scene.read({"environment": {"kind": "image"}})).panorama
    assert own is not None
    assert (own == light_box()).all()


def test_a_stage_uses_the_uploads_that_its_scene_names() -> None:
    assert Stage.of(NAMING, UPLOADS).uses() == {"m1", "s1"}
    assert Stage.of(Scene.read({"environment": {"kind": "image", "image": "light-box"}})).uses() == frozenset()
    assert uploads_of(Scene(), NAMING.environment) == {"s1"}


@pytest.mark.parametrize(
    ("scene", "field", "error"),
    [
        ({"stones": [{"mesh": "gone"}]}, "stones.0.mesh", SceneError),
        ({"environment": {"kind": "image", "image": "gone"}}, "environment.image", SceneError),
        ({"stones": [{"cut": {"star_percent": 1}}]}, "stones.0.cut", MeshError),
    ],
)
def test_what_cannot_be_resolved_is_named(scene: dict[str, object], field: str, error: type[SceneError]) -> None:
    with pytest.raises(error) as caught:
        Stage.of(Scene.read(scene), UPLOADS)
    assert caught.value.field is not None
    assert caught.value.field.startswith(field)


def test_what_a_stage_had_outlives_the_library() -> None:
    before = Stage.of(NAMING, UPLOADS)
    film = NAMING.film.model_copy(update={"exposure": 2.0})
    after = Stage.of(NAMING.model_copy(update={"film": film}), Library(), before=before)
    assert after.shapes == before.shapes
    assert after.panorama is before.panorama
    assert after.scene.film.exposure == 2


def test_another_mesh_or_sky_is_not_taken_from_before() -> None:
    before = Stage.of(NAMING, UPLOADS)
    with pytest.raises(SceneError):
        Stage.of(Scene.read({"stones": [{"mesh": "m2"}]}), UPLOADS, before=before)
    with pytest.raises(SceneError):
        Stage.of(Scene.read({"environment": {"kind": "image", "image": "s2"}}), UPLOADS, before=before)


def test_a_scene_of_the_same_stones_is_shown_on_the_same_stage_and_of_others_refused() -> None:
    stage = Stage.of(NAMING, UPLOADS)
    turned = NAMING.model_copy(update={"camera": NAMING.camera.model_copy(update={"fov_degrees": 20.0})})
    assert stage.showing(turned) == Stage.of(turned, UPLOADS)
    for other in (
        Scene(environment=NAMING.environment),
        NAMING.model_copy(update={"environment": Scene().environment}),
    ):
        with pytest.raises(ValueError, match="expected a scene of"):
            stage.showing(other)


def test_a_stage_goes_under_another_sky_and_its_stones_elsewhere() -> None:
    stage = Stage.of(NAMING, UPLOADS)
    dark = stage.under(Sky(DarkEnvironment(kind="dark")))
    assert (dark.scene.environment.kind, dark.panorama, dark.shapes) == ("dark", None, stage.shapes)
    assert dark.under(stage.sky) == stage
    assert dark.under(stage.sky).panorama is stage.panorama
    pose = (1.0, 2.0, 3.0), (0.0, 1.0, 0.0, 0.0)
    stone = stage.posed([pose]).scene.stones[0]
    assert (stone.position, stone.orientation) == pose
    with pytest.raises(ValueError, match="zip"):
        stage.posed([pose, pose])
