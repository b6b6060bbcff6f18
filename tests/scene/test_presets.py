"""Named scenes: every one renders, and the report's own keeps the report's constants."""

from __future__ import annotations

import io

import numpy as np
import PIL.Image
import pytest

from culet.errors import NotFoundError
from culet.rendering.chains import bands_seen
from culet.rendering.renderer import Renderer
from culet.scene import PRESETS, Scene, preset
from culet.scene.backdrop import NoBackdrop
from culet.scene.cuts import BrilliantCut
from culet.scene.optics import SPECTRAL_AT_REST, Optics
from culet.scene.room import Plane
from culet.scene.sky import ConstantEnvironment
from culet.scene.thumbnails import SIZE, thumbnail_of
from rendering.views import BARE, radiance, take, without_stone


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_shows_a_stone(renderer: Renderer, name: str) -> None:
    scene = preset(name)
    picture, empty = (take(renderer, each, size=(64, 36)) for each in (scene, without_stone(scene)))
    pixels = radiance(picture)
    assert np.isfinite(pixels).all()
    assert pixels.min() >= 0 or bands_seen(scene, 1) > 3  # spectral colours lie outside of the screen's
    assert (abs(pixels - radiance(empty)).max(axis=-1) > 0.01).mean() > 0.005  # measured 0.020, far away, to 0.24
    assert picture.segments() > 0


def test_an_unknown_preset_is_refused_with_those_that_exist() -> None:
    with pytest.raises(NotFoundError, match="no preset 'nmae'; there are: default, "):
        preset("nmae")


def test_every_preset_says_in_a_line_what_it_is() -> None:
    for each in PRESETS.values():
        assert 10 < len(each.summary) < 100
        assert each.summary.endswith(".")
        assert 2 < len(each.title) < 20


def test_every_preset_has_a_small_picture() -> None:
    for name in PRESETS:
        data = thumbnail_of(name)
        with PIL.Image.open(io.BytesIO(data)) as picture:
            assert (picture.format, picture.size) == ("WEBP", SIZE)
        assert len(data) < 12_000


def test_the_default_preset_is_the_default_scene_and_spectral_at_rest() -> None:
    assert preset("default") == Scene(optics=SPECTRAL_AT_REST)


def test_the_default_stone_fills_three_fifths_of_the_pictures_height(renderer: Renderer) -> None:
    """Its outline, tinted against a uniform sky: the rows that it changes, of 360."""
    data = {**BARE, "environment": {"kind": "constant"}, "stones": [{"absorption": [1, 1, 1]}]}
    data |= {"backdrop": {"kind": "none"}, "head": None}
    picture = take(renderer, Scene.read(data), size=(640, 360))
    stone = (radiance(picture) < 0.999).any(axis=-1)
    rows, columns = (np.unique(places) for places in np.nonzero(stone))
    assert 0 < rows[0] < rows[-1] < 359
    assert 0 < columns[0] < columns[-1] < 639
    assert 0.55 < len(rows) / 360 < 0.65  # measured 0.592


@pytest.mark.parametrize("name", ["face-up", "aset"])
def test_face_up_the_eightfold_outline_looks_the_same_turned_by_a_quarter(renderer: Renderer, name: str) -> None:
    """A brilliant has eight mains, so that its outline is its own after 45 degrees; of a square picture after 90."""
    plain = {
        "environment": ConstantEnvironment(kind="constant"),
        "emitters": (),
        "floor": Plane(),
        "backdrop": NoBackdrop(),
        "head": None,
    }
    scene = preset(name).model_copy(update={**plain, "optics": Optics()})
    tinted = scene.stones[0].model_copy(update={"absorption": (1, 1, 1)})
    pixels = radiance(take(renderer, scene.model_copy(update={"stones": (tinted,)}), size=(180, 180)))
    stone = (pixels < 0.999).any(axis=-1)
    assert 0.4 < stone.mean() < 0.55  # measured 0.484
    assert (stone != np.rot90(stone)).mean() < 0.001  # measured 0.0


def aset_parts(renderer: Renderer, cut: BrilliantCut) -> tuple[float, float, float, float]:
    """Of the face in the preset `aset`, the parts where red, green or blue is brightest, and those that leak.

    The sky's colours add up to 1 above the horizon and to 0 below: what shows less than 0.4 has leaked the rest.
    """
    scene = preset("aset")
    stone = scene.stones[0].model_copy(update={"cut": cut})
    pixels = radiance(take(renderer, scene.model_copy(update={"stones": (stone,)}), size=(180, 180)))
    rows, columns = np.mgrid[0:180, 0:180] - 89.5
    face = pixels[np.hypot(rows, columns) < 60]  # the outline's radius is 70
    red, green, blue = (float((face.argmax(axis=-1) == channel).mean()) for channel in range(3))
    return red, green, blue, float((face.sum(axis=-1) < 0.4).mean())


def test_the_aset_preset_shows_a_red_face_with_blue_arrows_that_hardly_leaks(renderer: Renderer) -> None:
    red, green, blue, leaks = aset_parts(renderer, BrilliantCut())
    assert red > 0.55  # measured 0.630
    assert 0.2 < blue < 0.4  # measured 0.301
    assert green < 0.1  # measured 0.069
    assert leaks < 0.02  # measured 0.013


def test_a_pavilion_too_steep_leaks_in_the_aset_preset(renderer: Renderer) -> None:
    assert aset_parts(renderer, BrilliantCut(pavilion_degrees=44))[3] > 0.03  # measured 0.054


def test_the_classic_scene_has_the_reports_constants() -> None:
    """Camera, lights, indices, bounces, absorption and the numbers of its physics, as it publishes them."""
    scene = preset("classic")
    assert [*scene.camera.position, scene.camera.fov_degrees] == [0, 2, 13, 45]
    assert scene.camera.target[1] < scene.camera.position[1]  # slightly down
    assert [light.position for light in scene.points] == [(-4, 6, 4), (4, 6, 4)]
    assert [light.colour for light in scene.points] == [(1, 0.2, 0.2), (0.2, 0.5, 1)]
    assert list(scene.stones[0].position) == [0, 4, 0]
    assert list(scene.stones[0].absorption) == [0.02] * 3
    assert (scene.optics.estimator, scene.optics.fresnel, scene.optics.max_bounces) == ("classic", "schlick", 12)
    assert scene.film.tone_map == "classic"
    physics = scene.simulation
    assert (physics.model, physics.inertia) == ("classic", "cone")
    assert (scene.stones[0].mass, scene.stones[0].spin) == (2, (0.5, 3, 0))
    assert (physics.gravity, physics.time_step, physics.restitution) == (9.81, 1 / 30, 0.6)
    assert (physics.velocity_threshold, physics.tangential_damping, physics.angular_damping) == (0.1, 0.9, 0.75)
    assert (physics.random_torque, physics.random_torque_speed) == (5, 2)
