"""Several stones in one scene: no light between them is lost or made, and what holds for one stone holds for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from conftest import RendererOf
from culet.errors import SceneError
from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.rendering.features import Features, Geometry, Stones, features_of
from culet.rendering.renderer import Picture, Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.scene.stone import StoneSettings
from culet.stage import NOTHING, Stage
from pictures import compared
from rendering.views import BARE, Array, radiance
from shared.stones import ring

SIZE = 96, 54
VIEW: dict[str, Any] = {"camera": {"position": [0, 2.4, 4], "target": [0, -0.3, 0]}}
FURNACE: dict[str, Any] = {
    **BARE,
    **VIEW,
    "environment": {"kind": "constant"},
    "optics": {"cutoff": 1e-6, "max_bounces": 65536},
}
TRIO: list[dict[str, Any]] = [
    {"material": {"ior": [2.41, 2.43, 2.45]}, "position": [-1.3, -0.37, 0]},
    {"material": {"ior": [1.76, 1.77, 1.78]}, "position": [0.6, -0.37, 0.3], "scale": 0.8},
    {"material": {"ior": [1.5, 1.52, 1.54]}, "position": [0, -0.2, -1.6], "scale": 1.2},
]


def stage(stones: Sequence[dict[str, Any]], shapes: Sequence[Shape] | None = None, **scene: object) -> Stage:
    """Brilliants, unless shapes are given."""
    placed = tuple(StoneSettings.model_validate(stone) for stone in stones)
    whole: Scene = legacy(dict(scene)).model_copy(update={"stones": placed})
    made = tuple(shapes or (shape_of(stone, {}) for stone in placed))
    return Stage(whole, made, NOTHING.sky(whole.environment).panorama)


def twelve() -> list[dict[str, Any]]:
    """A heap by chance: near each other, some within another, of three materials."""
    random = np.random.default_rng(12)
    return [
        {
            **TRIO[number % 3],
            "position": [*(random.random(3) * [2.4, 1.2, 2.0] - [1.2, 0.6, 1.0])],
            "orientation": [*random.normal(size=4)],
            "scale": 0.35,
        }
        for number in range(12)
    ]


def take(renderer: Renderer, of: Stage, features: Features | None = None, size: tuple[int, int] = SIZE) -> Picture:
    picture = renderer.picture(of, *size, features=features)
    picture.refine()
    return picture


@pytest.fixture(scope="module", params=[16, 4])
def lanes_renderer(request: pytest.FixtureRequest, renderer_of: RendererOf) -> Renderer:
    return renderer_of(request.param, np.float32)


@pytest.mark.parametrize("stones", [TRIO, twelve()], ids=["three", "twelve"])
def test_under_an_even_sky_stones_that_see_each_other_cannot_be_seen(
    lanes_renderer: Renderer, exact: Renderer, stones: list[dict[str, Any]]
) -> None:
    for used, tolerance in ((lanes_renderer, 1e-6), (exact, 1e-14)):
        picture = take(used, stage(stones, **FURNACE))
        seen, cut = radiance(picture).mean(axis=-1), picture.cut_map().astype(float)
        with compared(seen + cut, 1):
            assert seen + cut == pytest.approx(1, abs=tolerance)
        assert 0 < cut.mean() < 1e-5
        assert (cut > 0).mean() > 0.1  # the stones are in the picture


def test_how_the_scene_orders_stones_changes_no_bit(renderer: Renderer) -> None:
    there, back = (take(renderer, stage(stones, **VIEW)) for stones in (TRIO, TRIO[::-1]))
    assert (radiance(there) == radiance(back)).all()


def test_one_stone_in_a_table_looks_as_it_does_alone(exact: Renderer) -> None:
    one = stage(TRIO[:1], **VIEW)
    alone, in_table = take(exact, one), take(exact, one, replace(features_of(one), stones=Stones.MANY))
    assert alone.segments() == in_table.segments() > 0
    with compared(radiance(in_table), radiance(alone)):
        assert radiance(in_table) == pytest.approx(radiance(alone), abs=1e-9)


def test_single_precision_shows_what_double_does(renderer: Renderer, exact: Renderer) -> None:
    """But where rounding decides on which side of an edge light goes."""
    single, double = (radiance(take(used, stage(twelve(), **VIEW))) for used in (renderer, exact))
    difference: Array = abs(single - double).max(axis=-1)
    assert (difference > 1e-3).mean() < 0.02
    assert single.mean() == pytest.approx(double.mean(), rel=1e-4)


def test_convex_stones_and_others_share_a_scene(renderer: Renderer, exact: Renderer) -> None:
    shapes = [ring(), shape_of(StoneSettings(), {}), shape_of(StoneSettings(), {})]
    for used, tolerance in ((renderer, 2e-6), (exact, 1e-12)):
        of = stage(TRIO, shapes, **{**FURNACE, "optics": {"cutoff": 1e-3, "max_bounces": 65536}})
        assert features_of(of).geometry == Geometry.MESH
        picture = take(used, of)
        assert radiance(picture).mean(axis=-1) + picture.cut_map() == pytest.approx(1, abs=tolerance)


def test_the_classic_estimator_keeps_to_one_stone() -> None:
    with pytest.raises(SceneError, match=r"optics.estimator: expected chain.* got classic and 3 stones"):
        features_of(stage(TRIO, optics={"estimator": "classic"}))
