"""Several stones in one scene: no light between them is lost or made, and what holds for one stone holds for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from conftest import RendererOf
from culet.errors import SceneError
from culet.geometry.half_spaces import shape_from_half_spaces
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


def brick(half_height: float) -> Shape:
    """2 x 2 and twice the half height, scaled to circumradius 1."""
    extents = (1.0, half_height, 1.0)
    planes = [[*(sign * np.eye(3)[axis]), extent] for axis, extent in enumerate(extents) for sign in (1, -1)]
    return shape_from_half_spaces("brick", np.array(planes))


def bricks(*places: tuple[float, float]) -> Stage:
    """Bricks of glass by their height and half height, seen from straight below, under a sky that is 1 above."""
    glass = {"material": {"ior": [1.5] * 3}, "orientation": [1, 0, 0, 0]}
    stones = [{**glass, "position": [0, y, 0], "scale": np.sqrt(2 + h * h)} for y, h in places]
    camera = {"kind": "orthographic", "position": [0, -5, 0], "target": [0, 0, 0], "up": [0, 0, 1], "height": 0.5}
    sky = {"kind": "half", "radiance": [1, 1, 1]}
    shapes = [brick(h) for _, h in places]
    return stage(stones, shapes, **{**FURNACE, "environment": sky, "camera": camera})


@pytest.mark.parametrize("gap", [0.0, 1e-5, 0.1, -1e-5])
def test_halves_of_a_cut_stone_have_two_more_surfaces_whatever_the_gap(exact: Renderer, gap: float) -> None:
    """Of n surfaces that each reflect R of the light that falls on them straight, (1 - R) / (1 + (n - 1) R) goes
    through (G. G. Stokes, Proc. R. Soc. Lond. 11, 545 (1862)). A gap of nothing is a gap; so is a small overlap."""
    reflected = (0.5 / 2.5) ** 2
    halves = radiance(take(exact, bricks((0.3 + gap / 2, 0.3), (-0.3 - gap / 2, 0.3)), size=(8, 8)))
    whole = radiance(take(exact, bricks((0, 0.6)), size=(8, 8)))
    assert whole == pytest.approx((1 - reflected) / (1 + reflected), abs=2e-6)  # the cut-off; measured 3.3e-7
    assert halves == pytest.approx((1 - reflected) / (1 + 3 * reflected), abs=2e-5)


EXTREMES: dict[str, list[dict[str, Any]]] = {
    "one in another": [{**TRIO[0], "position": [0, 0, 0]}, {**TRIO[1], "position": [0.1, 0, 0], "scale": 0.2}],
    "two in one place": [{**TRIO[0], "position": [0, 0, 0]}, {**TRIO[0], "position": [0, 0, 0]}],
    "a grain on a boulder": [
        {**TRIO[0], "position": [0, -30.6, 0], "scale": 30.0, "orientation": [1, 0, 0, 0]},
        {**TRIO[1], "position": [0, 0.1, 0], "scale": 0.05},
    ],
    "points that touch": [{**TRIO[0], "position": [-1, 0, 0]}, {**TRIO[1], "position": [1, 0, 0], "scale": 1.0}],
    "as many as may be": [
        {**TRIO[k % 3], "position": [0.6 * (k % 8) - 2.1, -0.5, 0.6 * (k // 8) - 2.1], "scale": 0.3} for k in range(64)
    ],
}


@pytest.mark.parametrize("stones", EXTREMES.values(), ids=EXTREMES.keys())
def test_light_is_neither_lost_nor_made_however_stones_lie(renderer: Renderer, stones: list[dict[str, Any]]) -> None:
    of = stage(stones, **{**FURNACE, "optics": {"cutoff": 1e-4, "max_bounces": 65536}})
    picture = take(renderer, of)
    seen, cut = radiance(picture).mean(axis=-1), picture.cut_map().astype(float)
    assert seen + cut == pytest.approx(1, abs=2e-6)
    assert 0 < cut.mean() < 1e-3


def test_a_stone_out_of_sight_changes_nothing_that_is_seen(exact: Renderer) -> None:
    """But what light it throws back, some millionths of the sky."""
    far = {**TRIO[1], "position": [0, 0, 3000]}
    near, both = (radiance(take(exact, stage(stones, **{**BARE, **VIEW}))) for stones in (TRIO, [*TRIO, far]))
    difference: Array = abs(near - both).max(axis=-1)
    assert (difference > 1e-3).mean() < 0.01


def test_a_stone_of_twice_the_size_looks_the_same_from_twice_as_far(exact: Renderer) -> None:
    """If it absorbs half as much on each R."""
    pictures = []
    for scale in (1.0, 2.0):
        stone = {**TRIO[0], "position": [0, 0, 0], "scale": scale, "absorption": [c / scale for c in (0.1, 0.5, 2)]}
        camera = {"position": [0, 1.8 * scale, 3 * scale], "target": [0, 0, 0]}
        pictures.append(take(exact, stage([stone], **{**BARE, "environment": {"kind": "gradient"}, "camera": camera})))
    small, large = map(radiance, pictures)
    assert pictures[0].segments() == pytest.approx(pictures[1].segments(), rel=1e-4)
    assert large == pytest.approx(small, abs=1e-9)
