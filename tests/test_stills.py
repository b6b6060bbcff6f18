"""`culet.render`, as scripts and notebooks have it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from PIL import Image

import culet
from culet.errors import InputError, NotFoundError, SceneError
from culet.rendering.renderer import Renderer
from culet.scene import Scene, preset
from culet.stage import Stage
from engine.peer import TETRAHEDRON

SIZE = 24, 16
ALL_SKY: dict[str, Any] = {
    "stones": [],
    "floor": {"kind": "none"},
    "backdrop": {"kind": "none"},
    "environment": {"kind": "constant", "radiance": [0.25, 0.5, 8]},
    "film": {"tone_map": "none"},
}
"""A scene of whose sky nothing is hidden."""


def test_a_picture_is_linear_radiance_and_what_a_screen_shows_of_it() -> None:
    picture = culet.render(ALL_SKY, *SIZE, samples=1)
    assert (picture.width, picture.height) == SIZE
    assert picture.linear.shape == picture.rgb.shape == (16, 24, 3)
    assert picture.linear.dtype == np.float32
    assert picture.linear.reshape(-1, 3) == pytest.approx(np.tile([0.25, 0.5, 8], (24 * 16, 1)))
    assert (picture.rgb == [64, 128, 255]).all(), "0.25 and 0.5 of 255, rounded; 8 is clipped"


def test_a_picture_is_the_renderers_to_the_last_bit(renderer: Renderer) -> None:
    by_hand = renderer.picture(Stage.of(preset("fire")), *SIZE)
    by_hand.refine(3)
    picture = culet.render("fire", *SIZE, samples=3)
    assert picture.linear.tobytes() == by_hand.linear().tobytes()
    assert picture.rgb.tobytes() == by_hand.rgb().tobytes()


def test_what_a_picture_took_grows_with_its_samples() -> None:
    one, four = (culet.render("mirror", *SIZE, samples=samples) for samples in (1, 4))
    assert (one.cost.samples, four.cost.samples) == (1, 4)
    assert four.cost.rays == pytest.approx(4 * one.cost.rays, rel=0.1)  # measured 0.01
    assert one.cost.rays > 24 * 16, "a stone is in the picture, and light within the stone"
    assert culet.render(ALL_SKY, *SIZE, samples=3).cost.rays == 3 * 24 * 16, "nothing but the camera's"


def test_what_a_picture_misses_is_told() -> None:
    one, four = (culet.render("white", *SIZE, samples=samples) for samples in (1, 4))
    assert math.isnan(one.missed.error)
    assert 0 < four.missed.error < 1
    assert 0 < four.missed.cut < four.missed.bound
    assert math.isnan(four.missed.light_bound), "no caustics on this floor"
    assert f"too low by at most {four.missed.bound:.2g} (light of weight {four.missed.cut:.2g} cut off)" in repr(four)
    sunny = culet.render("sun", *SIZE, samples=1)
    assert sunny.missed.bound > sunny.linear.mean(), "whatever was cut off may have come from the sun"
    assert "which may all have come from the brightest lamp" in repr(sunny)
    nothing = culet.render(ALL_SKY, *SIZE, samples=1)
    assert nothing.missed.bound == 0


def test_a_picture_is_refined_to_the_error_that_is_asked_for_and_says_so() -> None:
    met = culet.render("white", *SIZE, error=0.02)
    assert met.met
    assert 0 < met.missed.shown_error <= 0.02
    assert 2 < met.cost.samples < 50  # measured 12
    assert f"estimated error as shown {met.missed.shown_error:.2g} (0.02 was asked for)" in met.quality()
    missed = culet.render("white", *SIZE, error=0.02, samples=met.cost.samples - 1)
    assert missed.met is False
    assert missed.missed.shown_error > 0.02
    assert "(but 0.02 was asked for)" in missed.quality()
    assert culet.render("white", *SIZE, samples=2).met is None, "none was asked for"
    assert "error not known (0.02 was asked for)" in culet.render("white", *SIZE, error=0.02, samples=1).quality()


def test_a_picture_looks_right_if_nobody_says_how_good_it_is_to_be() -> None:
    picture = culet.render("white", *SIZE)
    assert 16 < picture.cost.samples < 100  # measured 41
    assert 0 < picture.missed.shown_error <= 0.01
    assert (picture.error, picture.met) == (None, None), "none was asked for"
    assert culet.render(ALL_SKY, *SIZE).cost.samples == 16, "for smooth edges, though there is no error"


def test_a_scene_may_be_named_in_every_way(tmp_path: Path) -> None:
    scene = preset("ruby")
    file = tmp_path / "ruby.json"
    file.write_text(scene.model_dump_json())
    data = json.loads(file.read_text())
    found = [culet.load_scene(source) for source in ("ruby", scene, data, file, str(file))]
    assert found == [scene] * 5
    assert culet.load_scene() == Scene()


@pytest.mark.parametrize(
    ("source", "kind", "said"),
    [
        ("opal", NotFoundError, "no preset 'opal'; there are: default"),
        ("nowhere.json", SceneError, "nowhere.json: cannot be read"),
        ({"floor": {"kind": "lava"}}, SceneError, "floor.kind"),
        (7, SceneError, "expected a scene, the name of a preset"),
    ],
)
def test_what_is_no_scene_is_said_so(source: Any, kind: type[Exception], said: str) -> None:  # noqa: ANN401
    with pytest.raises(kind, match=said):
        culet.render(source, *SIZE)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"width": 0}, "width: expected 1 to 8192, got 0"),
        ({"height": 8193}, "height: expected 1 to 8192, got 8193"),
        ({"width": 6.5}, "width: expected a whole number from 1 to 8192, got 6.5"),
        ({"samples": 0}, "samples: expected 1 to 65536, got 0"),
        ({"samples": True}, "samples: expected a whole number"),
    ],
)
def test_an_impossible_size_names_its_field(arguments: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said) as refusal:
        culet.render("white", **arguments)
    assert refusal.value.field in arguments


def test_a_notebook_gets_the_pixels_as_a_png(tmp_path: Path) -> None:
    picture = culet.render(ALL_SKY, *SIZE, samples=1)
    (tmp_path / "shown.png").write_bytes(picture._repr_png_())
    with Image.open(tmp_path / "shown.png") as image:
        assert (np.asarray(image) == picture.rgb).all()


@pytest.mark.parametrize("ending", ["png", "webp", "tga"])
def test_a_saved_picture_holds_what_a_screen_shows(tmp_path: Path, ending: str) -> None:
    picture = culet.render("white", *SIZE, samples=1)
    saved = picture.save(tmp_path / f"gem.{ending}")
    with Image.open(saved) as image:
        assert (np.asarray(image) == picture.rgb).all()
    assert list(tmp_path.iterdir()) == [saved]


def test_a_saved_exr_holds_the_radiance(tmp_path: Path) -> None:
    picture = culet.render("white", *SIZE, samples=1)
    picture.save(str(tmp_path / "gem.EXR"))
    file = OpenEXR.File(str(tmp_path / "gem.EXR"))
    assert (file.channels()["RGB"].pixels == picture.linear).all()
    header = file.header()
    assert culet.load_scene(json.loads(header["culet.scene"])) == picture.scene
    assert (header["software"], header["comments"]) == (f"culet {culet.__version__}", picture.quality())


def test_a_picture_is_not_saved_under_an_ending_that_it_does_not_know(tmp_path: Path) -> None:
    picture = culet.render(ALL_SKY, *SIZE, samples=1)
    with pytest.raises(InputError, match=r"expected a name that ends in \.tga, .*; got 'gem\.gif'"):
        picture.save(tmp_path / "gem.gif")
    with pytest.raises(InputError, match="there is no folder"):
        picture.save(tmp_path / "missing" / "gem.png")
    assert list(tmp_path.iterdir()) == []


def test_files_take_the_place_of_stone_and_sky_and_what_is_found_in_them_is_told(tmp_path: Path) -> None:
    mesh, sky = tmp_path / "gem.off", tmp_path / "sky.png"
    mesh.write_bytes(TETRAHEDRON)
    Image.new("RGB", (16, 9), (255, 0, 255)).save(sky)
    picture = culet.render(ALL_SKY | {"environment": {"kind": "constant"}}, *SIZE, sky=sky, samples=1)
    assert picture.linear.mean((0, 1)) == pytest.approx([1, 0, 1], abs=1e-6)
    (finding,) = picture.findings
    assert finding.startswith(f"{sky}: 16 x 9 pixels are stretched")
    gem = culet.render("white", *SIZE, mesh=mesh, samples=1)
    assert gem.scene.stones[0].mesh == "file"
    assert not np.array_equal(gem.linear, culet.render("white", *SIZE, samples=1).linear)


def test_progress_goes_from_nothing_to_all() -> None:
    told: list[float] = []
    culet.render("white", *SIZE, samples=4, progress=told.append)
    assert told == sorted(told)
    assert 0 <= told[0] < told[-1] == 1


def test_a_transparent_picture_has_alpha(tmp_path: Path) -> None:
    picture = culet.render(ALL_SKY, *SIZE, background="transparent", samples=1)
    assert (picture.rgb == 0).all(), "nothing is there"
    assert picture.linear.shape == (16, 24, 4)
    with Image.open(picture.save(tmp_path / "gem.png")) as image:
        assert image.mode == "RGBA"
    said_so = culet.render(ALL_SKY | {"film": {"background": "transparent"}}, *SIZE, samples=1)
    assert (said_so.rgb == picture.rgb).all()
    colour = culet.render(ALL_SKY, *SIZE, background="#f4f1ea", samples=1)
    assert (colour.rgb == (0xF4, 0xF1, 0xEA)).all(), "to the last bit, whatever the tone map is"
    with pytest.raises(SceneError, match=r"film\.background: expected backdrop, .* as #f4f1ea; got 'blue'"):
        culet.render(ALL_SKY, *SIZE, background="blue")
