"""Pictures in front of nothing: alpha, exactly."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import PIL.Image
import pytest

from culet.rendering.cut_out import CutOut
from culet.rendering.film.files import encode
from culet.rendering.film.target import Target
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.stage import Stage
from rendering.views import take

SIZE = WIDTH, HEIGHT = 64, 36
SCENES: dict[str, dict[str, Any]] = {
    "studio": {},
    "no floor": {"floor": {"kind": "none"}},
    "spectral": {"optics": {"bands": 8}},
}


def cut_out(renderer: Renderer, scene: Scene, samples: int = 3) -> CutOut:
    picture = CutOut(renderer, Stage.of(scene), *SIZE)
    picture.refine(samples)
    return picture


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES.keys())
def test_over_a_colour_it_is_the_picture_before_a_backdrop_of_that_colour(
    renderer: Renderer, scene: dict[str, Any]
) -> None:
    linear = cut_out(renderer, Scene.read(scene)).linear()
    assert linear.shape == (HEIGHT, WIDTH, 4)
    grey = 0.3
    whole = take(
        renderer,
        Scene.read(scene | {"backdrop": {"kind": "plain", "colour": [grey] * 3}}),
        size=SIZE,
        samples=3,
    ).linear()
    composed = linear[..., :3] + (1 - linear[..., 3:]) * grey
    assert np.abs(composed - whole).max() < 1e-6  # measured 9e-8


def test_a_stone_is_opaque_what_is_beside_it_is_not_there_and_its_edge_is_in_between(renderer: Renderer) -> None:
    alpha = cut_out(renderer, Scene.read({"floor": {"kind": "none"}}), samples=8).linear()[..., 3]
    assert alpha[HEIGHT // 2, WIDTH // 2] == 1
    assert alpha[0, 0] == 0
    between = alpha[(alpha > 0) & (alpha < 1)]
    assert len(between) > 20
    assert between * 8 == pytest.approx(np.round(between * 8), abs=1e-4), "whole samples of each pixel"


def test_the_shadow_on_a_studios_floor_is_black_that_is_partly_there(renderer: Renderer) -> None:
    floor = {"kind": "studio", "reflectance": 0}
    linear = cut_out(renderer, Scene.read({"floor": floor})).linear()
    shadow = (linear[..., 3] > 0.2) & (linear[..., 3] < 0.8) & (linear[..., :3].max(axis=-1) < 1e-6)
    assert shadow.sum() > 20


def test_files_hold_alpha_as_their_formats_have_it(renderer: Renderer, tmp_path: Path) -> None:
    picture = cut_out(renderer, Scene())
    rgba, linear = picture.rgb(), picture.linear()
    assert rgba.shape == (HEIGHT, WIDTH, 4)
    assert (rgba[..., 3] == np.rint(255 * linear[..., 3])).all()

    def opened(name: str) -> PIL.Image.Image:
        return PIL.Image.open(io.BytesIO(encode(name, picture.rgb, picture.linear)))

    for name in ("png", "tga"):
        assert (np.asarray(opened(name)) == rgba).all(), name
    visible = rgba[..., 3] > 0
    assert (np.asarray(opened("webp"))[visible] == rgba[visible]).all()
    on_white = PIL.Image.new("RGBA", SIZE, "white")
    on_white.alpha_composite(PIL.Image.fromarray(rgba))
    jpeg = opened("jpeg")
    assert jpeg.mode == "RGB"
    assert np.abs(np.asarray(jpeg).astype(int) - np.asarray(on_white)[..., :3]).mean() < 3  # levels; measured 1
    (tmp_path / "a.exr").write_bytes(encode("exr", picture.rgb, picture.linear))
    channels = OpenEXR.File(str(tmp_path / "a.exr")).channels()
    assert (channels["RGBA"].pixels == linear.astype(np.float32)).all()


def test_what_is_opaque_is_developed_as_ever(renderer: Renderer) -> None:
    """The kernel and its reference differ by a level at most, where they round."""
    scene = Scene.read({"floor": {"kind": "none"}})
    transparent, whole = cut_out(renderer, scene).rgb(), take(renderer, scene, size=SIZE, samples=3).rgb()
    opaque = transparent[..., 3] == 255
    assert opaque.sum() > 100
    assert np.abs(transparent[opaque][:, :3].astype(int) - whole[opaque]).max() <= 1


def test_colours_are_those_of_what_is_there_however_little_is_there(renderer: Renderer) -> None:
    scene = Scene.read({"floor": {"kind": "none"}, "film": {"tone_map": "none", "exposure": 0.25}})
    picture = cut_out(renderer, scene, samples=8)
    linear, rgba = picture.linear(), picture.rgb()
    partly = (linear[..., 3] > 0.1) & (linear[..., 3] < 0.9) & (rgba[..., :3].max(axis=-1) < 255)
    assert partly.sum() > 20
    there = rgba[partly][:, :3] / 255 * linear[partly][:, 3:]
    assert np.abs(there - 0.25 * linear[partly][:, :3]).max() <= 0.5 / 255 + 1e-6, "half a level of rounding"


def test_before_a_colour_it_is_what_programs_make_of_the_transparent_one(renderer: Renderer) -> None:
    transparent = cut_out(renderer, Scene()).rgb()
    shown = cut_out(renderer, Scene.read({"film": {"background": "#f0c040"}})).rgb()
    over = PIL.Image.new("RGBA", SIZE, "#f0c040")
    over.alpha_composite(PIL.Image.fromarray(transparent))
    assert shown.shape == (HEIGHT, WIDTH, 3)
    assert np.abs(shown.astype(int) - np.asarray(over)[..., :3]).max() <= 1  # levels: Pillow rounds twice


def test_one_that_begins_anew_forgets_the_samples_of_both_pictures(renderer: Renderer) -> None:
    """As when its light map becomes another."""
    picture = cut_out(renderer, Scene(), samples=2)
    stale = picture.rgb()
    picture.begin_anew()
    picture.refine(2)
    assert picture.linear().tobytes() == cut_out(renderer, Scene(), samples=2).linear().tobytes()
    assert (picture.rgb() == stale).all()
    picture.refine(1)
    assert picture.linear().tobytes() == cut_out(renderer, Scene(), samples=3).linear().tobytes()


def test_its_error_is_that_before_whatever_is_behind(renderer: Renderer) -> None:
    """A black stone is right before black at once: what is noisy is its edge before white."""
    scene = Scene.read(
        {
            "floor": {"kind": "none"},
            "environment": {"kind": "constant", "radiance": [0, 0, 0]},
            "emitters": [],
            "stones": [{"absorption": [100, 100, 100]}],
            "film": {"background": "#ffffff"},
        }
    )
    picture = CutOut(renderer, Stage.of(scene), *SIZE)
    for _ in picture.refine_until(Target(8), math.inf):
        pass
    shown, told = picture.rgb() / 255, picture.shown_error()
    for _ in picture.refine_until(Target(256), math.inf):
        pass
    true = float(np.sqrt(np.mean((shown - picture.rgb() / 255) ** 2)))
    assert true > 1e-3
    assert 0.5 < told / true < 2.5
    assert not picture.meets(Target(256, 1e-6))


def test_rows_are_those_of_the_whole(renderer: Renderer) -> None:
    picture = cut_out(renderer, Scene())
    assert (picture.linear(slice(7, 20)) == picture.linear()[7:20]).all()
