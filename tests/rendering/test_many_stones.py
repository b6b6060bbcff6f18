"""Several stones in one scene: no light between them is lost or made, and what holds for one stone holds for each."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import RendererOf
from culet.errors import SceneError
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.rendering.chains import GROUPS, chain_table
from culet.rendering.features import Features, Geometry, StoneCount, features_of
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import Scene
from culet.scene.legacy import legacy
from culet.scene.room import FLOOR_Y, Plane
from culet.scene.stone import StoneSettings
from culet.simulation.rigid_body.rotation import normalised, product, rotate
from culet.simulation.rigid_body.state import Quaternion
from culet.simulation.staged import world_of
from culet.stage import NOTHING, Stage
from culet.study.bench.cases import ring as ring_of_5000
from culet.study.contacts.worlds import triple
from pictures import compared
from rendering.room_reference import span, world_half_spaces
from rendering.views import BARE, Array, pixel_directions, radiance
from shared.stones import brilliant, ring, star

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


POLARISED_BANDS: dict[str, Any] = {"bands": 4, "polarised": True}


def of_materials(stones: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The same with measured dispersion, by turns of their three indices."""
    names = {2.41: "diamond", 1.76: "spinel", 1.5: "bk7"}
    return [{**stone, "material": names[stone["material"]["ior"][0]]} for stone in stones]


def under_any_sky(of: Stage) -> Features:
    """The program for what light carries there, shared by all skies and by stones of any facets."""
    return features_of(of).general


def take(
    renderer: Renderer, of: Stage, features: Features | None = None, size: tuple[int, int] = SIZE
) -> DevicePicture:
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


def test_stones_of_one_shape_look_as_they_do_to_the_program_of_any_shapes(lanes_renderer: Renderer) -> None:
    scene = stage(twelve(), **{**FURNACE, "environment": {"kind": "dark"}})
    needed = features_of(scene)
    assert needed.alike == 1
    assert features_of(stage(TRIO, [brilliant(), brilliant(), star()])).alike == 0
    own, of_any = (radiance(take(lanes_renderer, scene, features)) for features in (needed, replace(needed, alike=0)))
    assert np.sqrt(np.mean((own - of_any) ** 2)) < 1e-6
    assert own.std() > 0.01


def test_one_stone_in_a_table_looks_as_it_does_alone(exact: Renderer) -> None:
    one = stage(TRIO[:1], **VIEW)
    alone, in_table = take(exact, one), take(exact, one, replace(features_of(one), stones=StoneCount.MANY))
    assert alone.segments() == in_table.segments() > 0
    with compared(radiance(in_table), radiance(alone)):
        assert radiance(in_table) == pytest.approx(radiance(alone), abs=1e-9)


def mean_in_sigmas(single: Array, double: Array) -> float:
    """The mean difference, over that of differences each of which is as likely positive as negative."""
    signed: Array = (single - double).mean(axis=-1)
    return float(signed.sum() / np.linalg.norm(signed))


def test_single_precision_shows_what_double_does(renderer: Renderer, exact: Renderer) -> None:
    """But where rounding decides on which side of an edge light goes."""
    single, double = (radiance(take(used, stage(twelve(), **VIEW))) for used in (renderer, exact))
    difference: Array = abs(single - double).max(axis=-1)
    assert (difference > 1e-3).mean() < 0.02
    assert abs(mean_in_sigmas(single, double)) < 3  # measured 1.1, and 1.7 to 3.0 at 960 x 540
    assert single.mean() == pytest.approx(double.mean(), rel=1e-3)  # 2.5e-4, of which two pixels are most


def test_convex_stones_and_others_share_a_scene(renderer: Renderer, exact: Renderer) -> None:
    shapes = [ring(), shape_of(StoneSettings(), {}), shape_of(StoneSettings(), {})]
    for used, tolerance in ((renderer, 2e-6), (exact, 1e-12)):
        of = stage(TRIO, shapes, **{**FURNACE, "optics": {"cutoff": 1e-3, "max_bounces": 65536}})
        assert features_of(of).geometry == Geometry.MESH
        picture = take(used, of)
        assert radiance(picture).mean(axis=-1) + picture.cut_map() == pytest.approx(1, abs=tolerance)


def around_a_ring(**optics: object) -> Stage:
    """Six brilliants that see each other and a ring of 5000 triangles."""
    angles = np.arange(6) * np.pi / 3
    stones = [{"position": [1.05 * np.cos(a), -0.67, 1.05 * np.sin(a)], "scale": 0.45} for a in angles]
    stones.append({"position": [0, -0.2, 0], "scale": 0.8, "orientation": [math.sqrt(0.5), math.sqrt(0.5), 0, 0]})
    shapes = [*(shape_of(StoneSettings(), {}) for _ in angles), ring_of_5000()]
    return stage(stones, shapes, **VIEW, optics={"cutoff": 1e-4, **optics})


def test_single_precision_takes_another_way_after_hundreds_of_reflections_alone(
    renderer: Renderer, exact: Renderer
) -> None:
    """Each reflection rounds light's direction, which after 500 is off by 2e-6, and its place by 3.5e-4 R: it passes
    the edge before which it was reflected. A facet that was missed would be seen after a few."""
    for max_bounces, most, rms in ((16, 1e-3, 1e-4), (65536, 0.01, 0.01)):  # measured 1.4e-4, 2.2e-5; 0.006, 0.005
        of = around_a_ring(max_bounces=max_bounces)
        single, double = (radiance(take(used, of, under_any_sky(of), (160, 90))) for used in (renderer, exact))
        difference: Array = abs(single - double).max(axis=-1)
        assert (difference > 1e-3).mean() < most
        assert np.sqrt(((single - double) ** 2).mean()) < rms
        assert abs(mean_in_sigmas(single, double)) < 3


def test_the_classic_estimator_keeps_to_one_stone() -> None:
    with pytest.raises(SceneError, match=r"optics.estimator: expected chain.* got classic and 3 stones"):
        features_of(stage(TRIO, optics={"estimator": "classic"}))


def brick(half_height: float) -> Shape:
    """2 x 2 and twice the half height, scaled to circumradius 1."""
    extents = (1.0, half_height, 1.0)
    planes = [[*(sign * np.eye(3)[axis]), extent] for axis, extent in enumerate(extents) for sign in (1, -1)]
    return shape_from_half_spaces("brick", np.array(planes))


def bricks(*places: tuple[float, float], materials: Sequence[object] = (), **optics: object) -> Stage:
    """Bricks by their height and half height, of glass or these materials, seen from straight below, under a sky that
    is 1 above."""
    glass: list[object] = [{"ior": [1.5] * 3}] * len(places)
    stones = [
        {"material": material, "position": [0, y, 0], "orientation": [1, 0, 0, 0], "scale": np.sqrt(2 + h * h)}
        for (y, h), material in zip(places, materials or glass, strict=True)
    ]
    camera = {"kind": "orthographic", "position": [0, -5, 0], "target": [0, 0, 0], "up": [0, 0, 1], "height": 0.5}
    sky = {"kind": "half", "radiance": [1, 1, 1]}
    shapes = [brick(h) for _, h in places]
    view = {"environment": sky, "camera": camera, "optics": {**FURNACE["optics"], **optics}}
    return stage(stones, shapes, **{**FURNACE, **view})


@pytest.mark.parametrize("gap", [0.0, 1e-5, 0.1, -1e-5])
def test_halves_of_a_cut_stone_have_two_more_surfaces_whatever_the_gap(exact: Renderer, gap: float) -> None:
    """Of n surfaces that each reflect R of the light that falls on them straight, (1 - R) / (1 + (n - 1) R) goes
    through (G. G. Stokes, Proc. R. Soc. Lond. 11, 545 (1862)). A gap of nothing is a gap; so is a small overlap."""
    reflected = (0.5 / 2.5) ** 2
    halves = radiance(take(exact, bricks((0.3 + gap / 2, 0.3), (-0.3 - gap / 2, 0.3)), size=(8, 8)))
    whole = radiance(take(exact, bricks((0, 0.6)), size=(8, 8)))
    assert whole == pytest.approx((1 - reflected) / (1 + reflected), abs=2e-6)  # the cut-off; measured 3.3e-7
    assert halves == pytest.approx((1 - reflected) / (1 + 3 * reflected), abs=2e-5)


def test_each_stone_of_a_pile_has_the_index_of_its_own_material(exact: Renderer) -> None:
    """1 / T - 1 is the sum of R / (1 - R) over all surfaces that light falls on straight (Stokes, as above, for any R).
    Each brick differs from the others in what it passes, in each channel."""
    indices = np.array([[1.4, 1.5, 1.6], [2.2, 2.4, 2.6], [1.8, 1.75, 1.7]])
    reflected = ((indices - 1) / (indices + 1)) ** 2
    expected = 1 / (1 + (2 * reflected / (1 - reflected)).sum(axis=0))
    pile = bricks((0.7, 0.3), (0, 0.2), (-0.6, 0.25), materials=[{"ior": [*each]} for each in indices])
    seen = radiance(take(exact, pile, size=(4, 4)))
    assert seen == pytest.approx(np.broadcast_to(expected, seen.shape), abs=1e-4)


def test_each_stone_of_a_pile_has_the_index_of_its_own_material_at_each_wavelength(exact: Renderer) -> None:
    """Polarised as well, which at these surfaces changes nothing."""
    materials = ["bk7", "diamond"]
    pile = bricks((0.5, 0.3), (-0.4, 0.2), materials=materials, **POLARISED_BANDS, cutoff=1e-9)
    chains = chain_table(pile.scene, 0, np.float64, common=False).reshape(len(materials), -1)
    reflected = ((chains["eta"] - 1) / (chains["eta"] + 1)) ** 2
    passed = 1 / (1 + (2 * reflected / (1 - reflected)).sum(axis=0))
    expected = np.array([passed[group::GROUPS] @ chains["share"][0, group::GROUPS] for group in range(GROUPS)])
    pixels = radiance(take(exact, pile, under_any_sky(pile), size=(8, 8))).reshape(-1, 3)
    distance = abs(pixels[:, None] - expected[None]).max(axis=-1)
    assert np.bincount(distance.argmin(axis=1)).tolist() == [16] * GROUPS
    assert distance.min(axis=1).max() < 1e-6


@pytest.mark.parametrize("stones", [TRIO, twelve()], ids=["three", "twelve"])
@pytest.mark.parametrize("optics", [{"bands": 4}, {"polarised": True}, POLARISED_BANDS], ids=str)
def test_white_stays_white_among_stones_whatever_light_carries(
    renderer: Renderer, stones: list[dict[str, Any]], optics: dict[str, Any]
) -> None:
    """By wavelength or polarised, what is cut bounds what is missing: channels see parts of either sign."""
    of = stage(of_materials(stones), **{**FURNACE, "optics": {**FURNACE["optics"], **optics}})
    picture = take(renderer, of, under_any_sky(of))
    seen, cut = radiance(picture), picture.cut_map().astype(float)
    with compared(seen, 1):
        assert (abs(seen.mean(axis=-1) - 1) <= cut + 5e-7).all()  # measured 1.4e-7 beyond
        assert seen == pytest.approx(1, abs=2e-5)  # measured 3.5e-6 and 9.7e-6
    assert 0 < cut.mean() < 1e-5  # measured 2.9e-7 to 4.3e-7
    assert (cut > 0).mean() > 0.1  # the stones are in the picture


def test_polarised_bands_among_stones_are_in_single_precision_what_they_are_in_double_in_whatever_order(
    renderer: Renderer, exact: Renderer
) -> None:
    """But where rounding decides on which side of an edge light goes. Another order changes no bit."""
    sky = {"kind": "gradient", "bottom": [1, 0.5, 2], "top": [2, 1, 0.5]}
    there, back = (
        stage(of_materials(stones), **{**FURNACE, "environment": sky, "optics": FURNACE["optics"] | POLARISED_BANDS})
        for stones in (twelve(), twelve()[::-1])
    )
    single, turned, double = (
        radiance(take(used, of, under_any_sky(of)))
        for used, of in ((renderer, there), (renderer, back), (exact, there))
    )
    assert (single == turned).all()
    difference: Array = abs(single - double).max(axis=-1)
    with compared(single, double):
        assert (difference > 1e-3).mean() < 0.004  # measured 0.0017
        assert abs(mean_in_sigmas(single, double)) < 3  # measured 1.4, and 0.2 at 400 x 225


def clear(**settings: Any) -> dict[str, Any]:  # noqa: ANN401
    """A stone of index 1: light goes straight through, and is absorbed."""
    return {"material": {"ior": [1, 1, 1]}, **settings}


def clear_program(of: Stage) -> Features:
    """For clear stones, shared by eyes inside and outside, with and without a floor."""
    return features_of(of).general


JUST_BELOW = 1e-3
"""R: from there light still sees the floor, as from a stone that rests on it."""


def straight_on(of: Stage, eye_inside: int | None = None) -> tuple[Array, NDArray[np.bool_]]:
    """(height, width, 3) optical depth of what is before each pixel, and whether the floor stops its line.

    Light on its way belongs to the stone that it entered first, until it leaves that stone; if it then is within
    another, to that one. NaN where it then is within several others: to which of them is not said. A stone that reaches
    through the floor is a hole in the floor; NaN where light leaves a stone just below.
    """
    direction = pixel_directions(of.scene, *SIZE).reshape(-1, 3)
    origin = np.tile(np.array(of.scene.camera.position, float), (len(direction), 1))
    spans = [
        span(world_half_spaces(of.scene, shape, number), origin, direction) for number, shape in enumerate(of.shapes)
    ]
    floor = np.full(len(direction), math.inf)
    if of.scene.floor.kind != "none":
        floor = np.where(direction[:, 1] < 0, (FLOOR_Y - origin[:, 1]) / direction[:, 1], math.inf)
    depth, stopped = np.zeros(direction.shape), np.zeros(len(direction), bool)
    for pixel in range(len(direction)):
        t, ways = 0.0, [(float(enter[pixel]), float(leave[pixel]), n) for n, (enter, leave) in enumerate(spans)]
        first = eye_inside
        while ahead := [(max(enter, t), leave, n) for enter, leave, n in ways if max(enter, t) < leave]:
            entry, end, number = min(ahead) if first is None else next(each for each in ahead if each[2] == first)
            if t < floor[pixel] < entry:
                break
            if first is None and sum(each[0] == entry for each in ahead) > 1:
                depth[pixel] = math.nan
            depth[pixel] += (end - entry) * np.array(of.scene.stones[number].absorption)
            t, first = end, None
            ways = [each for each in ways if each[2] != number]
            if 0 < (floor[pixel] - t) * direction[pixel, 1] < JUST_BELOW:
                depth[pixel] = math.nan
        stopped[pixel] = t < floor[pixel] < math.inf
    return depth.reshape(SIZE[1], SIZE[0], 3), stopped.reshape(SIZE[1], SIZE[0])


GRADIENT: dict[str, Any] = {
    **BARE, "environment": {"kind": "gradient", "bottom": [1, 0.5, 2], "top": [2, 1, 0.5]}, "optics": {"cutoff": 1e-9},
    "emitters": [],
}  # fmt: skip


def clear_twelve() -> list[dict[str, Any]]:
    """A heap of twelve sizes and colours."""
    random = np.random.default_rng(3)
    return [
        clear(**{**each, "scale": random.uniform(0.2, 0.6), "material": {"ior": [1, 1, 1]}, "absorption": [*colour]})
        for each, colour in zip(twelve(), random.random((12, 3)), strict=True)
    ]


def compare_straight(exact: Renderer, of: Stage, bare: Stage, eye_inside: int | None = None) -> NDArray[np.bool_]:
    """That light comes to each pixel straight through the stones; says which pixels the floor is seen in."""
    depth, stopped = straight_on(of, eye_inside)
    assert (depth > 0).any(axis=-1).mean() > 0.1
    said = np.isfinite(depth)
    assert said.mean() > 0.99
    without = replace(bare, scene=bare.scene.model_copy(update={"floor": Plane(kind="none")}))
    floor, sky = (radiance(take(exact, behind, clear_program(of))) for behind in (bare, without))
    seen = radiance(take(exact, of, clear_program(of)))
    expected = np.where(stopped[..., None], floor, sky) * np.exp(-depth)
    with compared(np.where(said, seen, 0), np.where(said, expected, 0)):
        assert seen[said] == pytest.approx(expected[said], abs=1e-5)  # overlaps of 2e-6 of a radius count as touching
    return stopped


def test_light_belongs_to_the_stone_that_it_entered_first_until_it_leaves_that_stone(exact: Renderer) -> None:
    """Through all of a heap, in their order, from where the eye is."""
    compare_straight(exact, stage(clear_twelve(), **GRADIENT, **VIEW), stage([], **GRADIENT, **VIEW))


def test_stones_that_reach_through_the_floor_are_holes_in_the_floor(exact: Renderer) -> None:
    """What is entered above the floor is left below the floor, also into another stone, and to the sky; what lies below
    the floor beside that is hidden."""
    room = {**GRADIENT, **VIEW, "floor": {"kind": "matte"}}
    sunk = [
        {**each, "position": [each["position"][0], each["position"][1] - 1, each["position"][2]]}
        for each in clear_twelve()
    ]
    stopped = compare_straight(exact, stage(sunk, **room), stage([], **room))
    depth, _ = straight_on(stage(sunk, **GRADIENT, **VIEW))
    within = (depth > 0).any(axis=-1)
    assert (within & stopped).mean() > 0.02
    assert (within & ~stopped).mean() > 0.02


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_an_eye_within_two_stones_is_in_the_one_in_which_it_is_deepest(
    exact: Renderer, order: tuple[int, int, int]
) -> None:
    shallow = clear(position=[0.1, 0.3, 0], absorption=[3, 0, 0], scale=0.8)
    deep = clear(position=[0, 0, 0.1], absorption=[0, 1, 0.2], scale=2)
    small = clear(position=[-1, 0, -3], absorption=[0, 0, 4], scale=0.7)
    camera: dict[str, Any] = {"camera": {"position": [0, 0.1, 0], "target": [-0.3, 0, -1], "fov_degrees": 70}}
    stones = [(shallow, deep, small)[number] for number in order]
    compare_straight(exact, stage(stones, **GRADIENT, **camera), stage([], **GRADIENT, **camera), eye_inside=1)


EXTREMES: dict[str, list[dict[str, Any]]] = {
    "one in another": [{**TRIO[0], "position": [0, 0, 0]}, {**TRIO[1], "position": [0.1, 0, 0], "scale": 0.2}],
    "two in one place": [{**TRIO[0], "position": [0, 0, 0]}, {**TRIO[0], "position": [0, 0, 0]}],
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


AS_IT_IS, HEAD_DOWN = (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)
ON_AN_EDGE = math.cos(math.pi / 8), 0.0, 0.0, math.sin(math.pi / 8)
ACROSS = math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0
ON_A_CORNER, LYING = (0.88, 0.36, 0.1, 0.3), (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)
ASKEW = (0.83, 0.21, -0.4, 0.32)


@dataclass(frozen=True)
class Touching:
    """One stone on another, moved until both touch."""

    shapes: tuple[Callable[[], Shape], Callable[[], Shape]]
    turned: tuple[Quaternion, Quaternion]
    corners: tuple[int, int]
    """Of each, in the horizontal plane between them: 1 for a point, 2 for an edge."""
    scales: tuple[float, float] = (1.0, 0.7)
    aside: float = 0.1
    """R, of the upper one."""

    def stage(self, askew: bool) -> Stage:
        """In the furnace, seen from near by, with what touches at the origin; askew: all is turned together."""
        turn = ASKEW if askew else AS_IT_IS
        stones, shapes = [], [make() for make in self.shapes]
        for number, (shape, own, scale, count) in enumerate(
            zip(shapes, self.turned, self.scales, self.corners, strict=True)
        ):
            ups = [scale * rotate(normalised(own), corner)[1] for corner in map(triple, shape.vertices)]
            height = min(ups) if number else max(ups)
            assert sum(abs(up - height) < 1e-6 for up in ups) == count
            aside = number * self.aside
            place = rotate(normalised(turn), (aside, -height, aside / 2))
            stones.append(
                {
                    **TRIO[number],
                    "id": f"stone-{number}",
                    "position": place,
                    "orientation": product(turn, own),
                    "scale": scale,
                }
            )
        camera = {
            name: rotate(normalised(turn), triple(min(self.scales) * np.array(place)))
            for name, place in (("position", (0.4, 1.2, 3.0)), ("target", (0.1, 0.0, 0.0)))
        }
        return stage(stones, shapes, **{**FURNACE, "camera": camera})


GEMS, BRICKS = (brilliant, brilliant), (partial(brick, 0.5), partial(brick, 0.3))
CUBES = (partial(brick, 1.0), partial(brick, 1.0))
TOUCHES: dict[str, Touching] = {
    "a culet on a table": Touching(GEMS, (AS_IT_IS, AS_IT_IS), (8, 1)),
    "a culet on a culet": Touching(GEMS, (HEAD_DOWN, AS_IT_IS), (1, 1), aside=0),
    "a corner on a face": Touching(BRICKS, (AS_IT_IS, ON_A_CORNER), (4, 1)),
    "an edge on a face": Touching(BRICKS, (AS_IT_IS, ON_AN_EDGE), (4, 2)),
    "an edge along an edge": Touching(CUBES, (ON_AN_EDGE, ON_AN_EDGE), (2, 2), aside=0),
    "an edge across an edge": Touching(CUBES, (ON_AN_EDGE, product(ACROSS, ON_AN_EDGE)), (2, 2), aside=0),
    "a table on a table": Touching(GEMS, (AS_IT_IS, HEAD_DOWN), (8, 8)),
    "corners on corners": Touching(GEMS, (AS_IT_IS, HEAD_DOWN), (8, 8), scales=(1, 1), aside=0),
    "a face on a face": Touching(BRICKS, (AS_IT_IS, AS_IT_IS), (4, 4)),
    "a face on a star's": Touching((star, BRICKS[1]), (LYING, AS_IT_IS), (10, 4)),
    "a grain's culet on a boulder": Touching(GEMS, (AS_IT_IS, AS_IT_IS), (8, 1), scales=(30, 0.05)),
    "a grain's table on a boulder": Touching(GEMS, (AS_IT_IS, HEAD_DOWN), (8, 8), scales=(30, 0.05)),
}


@pytest.mark.parametrize("touching", TOUCHES.values(), ids=TOUCHES.keys())
def test_light_is_neither_lost_nor_made_where_stones_touch(
    renderer: Renderer, exact: Renderer, touching: Touching
) -> None:
    """Where their sides are along the axes, too, and all that is computed of these is exact. Between faces that lie on
    each other light goes to and fro thousands of times."""
    for used, askew, tolerance in ((renderer, False, 1e-6), (renderer, True, 1e-6), (exact, True, 1e-12)):
        of = touching.stage(askew)
        world = world_of(of)
        one, other = (body.name for body in world.bodies)
        assert world.separation(one, other) == pytest.approx(0, abs=1e-6)  # measured 1e-15
        picture = take(used, of, size=(32, 18))
        seen, cut = radiance(picture).mean(axis=-1), picture.cut_map().astype(float)
        with compared(seen + cut, 1):
            assert seen + cut == pytest.approx(1, abs=tolerance)  # measured 8.8e-8 and 6e-14
        assert 0 < cut.mean() < 2e-5  # measured 1.0e-5, where faces lie on each other
        assert (cut > 0).mean() > 0.1  # the stones are in the picture


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
