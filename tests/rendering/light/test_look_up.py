"""Light maps as the kernels read them: made by hand, against the room by another account with the same light added."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from numpy.typing import NDArray

from culet.geometry.load import shape_of
from culet.rendering.emitters.light_map import BoundMap, frame_of, surfaces
from culet.rendering.emitters.sources import mapped_surfaces, sources_of, studio_light
from culet.rendering.features import RUNTIME, Features, features_of
from culet.rendering.renderer import Renderer
from culet.scene import PRESETS, Scene
from culet.scene.legacy import LEGACY_LAMPS, legacy
from pictures import compared
from rendering.room_reference import look_around
from rendering.views import Array, radiance, take
from shared.stages import staged

SIZE = 96, 54
SUN: dict[str, Any] = {"shape": "sun", "direction": [0.1, 1, 0.4], "colour": [0.5, 0.4, 0.3]}
POINT: dict[str, Any] = {"shape": "point", "position": [1, 6, 2], "colour": [0.5, 0.4, 0.3]}
MATTE: dict[str, Any] = {"kind": "matte"}
CAMERA: dict[str, Any] = {"position": [2, 7, 9], "target": [0, -1, -3], "fov_degrees": 75}
STONE: dict[str, Any] = {"position": [0.4, 1, -1]}
RIM = 1 / 16


def scene_of(**fields: object) -> Scene:
    """A matte room under a sun, seen from afar."""
    base = {"floor": MATTE, "walls": MATTE, "camera": CAMERA, "stones": [STONE], "emitters": [SUN]}
    return legacy({**base, "optics": {"cutoff": 1e-9}, **fields})


def slopes(surface: int, u: Array, v: Array) -> Array:
    """(..., 3) light that differs on each surface and rises evenly over it: what is between texels is known exactly."""
    parts = np.array([0.3 + 0.02 * surface, 0.25, 0.4 - 0.03 * surface])
    return np.asarray(parts + np.stack([0.01 * u, 0.02 * v, 0.01 * u - 0.015 * v], axis=-1))


def bound(renderer: Renderer, scene: Scene, light: Any = slopes) -> BoundMap:  # noqa: ANN401 - a function or a number
    """A map of the scene that holds that light at the texels' middles, or one number."""
    frame = frame_of(staged(scene))
    texels = np.full(frame.shape, np.nan, np.float32)
    for surface in frame.matte:
        for level in range(len(frame.halves)):
            u, v = np.meshgrid(*frame.texels(surface, level))
            texels[surface, level] = light(surface, u, v) if callable(light) else light
    flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
    return BoundMap(frame, lambda _: cl.Buffer(renderer.device.context, flags, hostbuf=texels))


def share(scene: Scene, which: NDArray[np.integer], point: Array) -> Array:
    """(N,) of the map, which falls to 0 at its outer rim; and u, v."""
    frame = frame_of(staged(scene))
    uv = np.stack([surface.coordinates(point) for surface in surfaces()])[which, np.arange(len(which))]
    apart = abs(uv - np.array(frame.centres)[which]).max(axis=1) / frame.halves[1]
    return np.asarray(np.column_stack([np.clip((1 - apart) / RIM, 0, 1), uv]))


def thrown(scene: Scene, which: NDArray[np.integer], point: Array) -> Array:
    """(N, 3) what `slopes` adds at points of surfaces."""
    part, u, v = share(scene, which, point).T
    return np.asarray(part[:, None] * np.stack([slopes(s, u, v) for s in range(4)])[which, np.arange(len(which))])


def compare(
    renderer: Renderer, scene: Scene, light_map: BoundMap, expected: Array, seen: NDArray[np.bool_], tolerance: float
) -> None:
    picture = radiance(take(renderer, scene, size=SIZE, light_map=light_map))
    with compared(np.where(seen[..., None], picture, 0), np.where(seen[..., None], expected, 0)):
        assert abs(picture - expected)[seen].max() < tolerance


ROOMS: dict[str, dict[str, Any]] = {
    "matte": {},
    "matte floor": {"walls": {"kind": "none"}},
    "matte walls": {"floor": {"kind": "none"}},
    "matte floor, mirror walls": {"walls": {"kind": "mirror"}},
    "mirror floor, matte walls": {"floor": {"kind": "mirror"}},
}


@pytest.mark.parametrize("room", ROOMS.values(), ids=ROOMS.keys())
def test_floor_and_walls_show_what_their_map_adds_to_their_light(exact: Renderer, room: dict[str, Any]) -> None:
    """On both levels, where they meet and where the map ends; seen in mirrors, and of a matte surface only. A map is in
    single precision, and at its very rim holds its outermost texel."""
    scene = scene_of(**room)
    expected = look_around(scene, shape_of(scene.stones[0], {}), *SIZE, lambda *at: thrown(scene, *at))
    bare = look_around(scene, shape_of(scene.stones[0], {}), *SIZE)
    assert (abs(expected.radiance - bare.radiance).max(axis=-1) > 0.05).mean() > 0.1
    compare(exact, scene, bound(exact, scene), expected.radiance, ~expected.stone, 5e-6)  # 2.2e-6


def test_single_precision_reads_the_same(renderer: Renderer) -> None:
    scene = scene_of()
    expected = look_around(scene, shape_of(scene.stones[0], {}), *SIZE, lambda *at: thrown(scene, *at))
    seen = radiance(take(renderer, scene, size=SIZE, light_map=bound(renderer, scene)))
    difference = abs(seen - expected.radiance).max(axis=-1)[~expected.stone]
    assert (difference > 1e-4).mean() < 0.02  # edges of the checker


def test_a_map_is_seen_through_a_stone(exact: Renderer) -> None:
    """A stone of index 1 is not there, but in the program: all light of the floor comes through it."""
    glass = {"material": {"ior": [1, 1, 1]}, **STONE}
    scene = scene_of(stones=[glass])
    expected = look_around(scene, None, *SIZE, lambda *at: thrown(scene, *at)).radiance
    compare(exact, scene, bound(exact, scene), expected, np.ones(SIZE[::-1], bool), 5e-6)  # 1.3e-6


def test_light_is_never_below_nothing(exact: Renderer) -> None:
    """Of a map that takes more than there is."""
    scene = scene_of(walls={"kind": "none"})
    expected = look_around(
        scene, shape_of(scene.stones[0], {}), *SIZE, lambda *at: -9 * share(scene, *at)[:, :1] * np.ones(3)
    )
    assert (expected.radiance[~expected.stone].max(axis=-1) == 0).mean() > 0.1
    compare(exact, scene, bound(exact, scene, -9), expected.radiance, ~expected.stone, 1e-11)


def test_a_points_shadow_is_the_maps_where_there_is_one_and_the_rays_beyond(exact: Renderer) -> None:
    """A map that holds no shadow: the shadow of a low light begins where the map ends, and fades in over its rim. What
    the map shows and what is seen without it make the expected picture, by the map's share."""
    low = {**POINT, "position": [6, 3, 2], "colour": [1, 1, 1]}
    camera = {"position": [-14, 9, 0], "target": [-12, -1, -4], "fov_degrees": 70}
    scene = scene_of(emitters=[low], stones=[{"position": [0, 1.6, 0]}], camera=camera, walls={"kind": "none"})
    stone = shape_of(scene.stones[0], {})
    shadowed, lit = look_around(scene, stone, *SIZE), look_around(scene.model_copy(update={"stones": ()}), None, *SIZE)
    even = legacy({"environment": {"kind": "constant"}}).environment
    ones = scene.model_copy(update={"emitters": (), "environment": even})
    white = look_around(ones, stone, *SIZE)
    parts = look_around(ones, stone, *SIZE, lambda *at: -share(scene, *at)[:, :1] * np.ones(3))
    part = 1 - parts.radiance / np.maximum(white.radiance, 1e-9)
    seen = ~shadowed.stone & (white.radiance[..., 0] > 0)
    expected = part * lit.radiance + (1 - part) * shadowed.radiance
    shade = (lit.radiance - shadowed.radiance).max(axis=-1)
    assert ((shade > 0.1) & seen & (part[..., 0] == 0)).sum() > 20
    assert ((shade > 0.1) & seen & (part[..., 0] > 0.1)).sum() > 20
    compare(exact, scene, bound(exact, scene, 0), expected, seen, 1e-9)


BACKDROP: dict[str, Any] = {"backdrop": {"kind": "plain", "colour": [0.3, 0.2, 0.1]}}
STUDIO: dict[str, Any] = {"floor": {"kind": "studio", "shadow": 0}, "walls": {"kind": "none"}}
LAMPS = [lamp.model_dump() for lamp in LEGACY_LAMPS]


@pytest.mark.parametrize("behind", [{}, BACKDROP], ids=["floor's colour", "backdrop"])
def test_a_studio_floor_shows_its_colour_times_the_part_of_its_light_that_arrives(
    exact: Renderer, behind: dict[str, Any]
) -> None:
    """Its map over all its light; wide lamps throw nothing there."""
    scene = scene_of(**STUDIO, **behind, emitters=[SUN, *LAMPS], stones=[{"position": [0, 30, 0]}])
    stage = staged(scene)
    assert len(sources_of(stage)) == 1
    _, gain = studio_light(stage, np.zeros(3))
    colour = np.array((0.3, 0.2, 0.1) if behind else scene.floor.colour)  # type: ignore[union-attr]
    empty = radiance(take(exact, scene, size=SIZE, light_map=bound(exact, scene, 0)))
    floor = abs(empty - colour).max(axis=-1) < 1e-9
    assert floor.mean() > 0.5
    dark = radiance(take(exact, scene, size=SIZE, light_map=bound(exact, scene, -0.1)))[floor]
    within = dark.min(axis=-1) < colour.min() * (1 - 1e-6)
    lowest = colour * (1 - 0.1 * gain)
    assert within.mean() > 0.2
    assert dark.min(axis=0) == pytest.approx(lowest, rel=1e-6)


def test_of_a_studio_floors_light_the_contact_shadow_takes_what_no_compact_lamp_gives(exact: Renderer) -> None:
    """Deep under a stone that lies on it, where the contact shadow takes all."""
    camera = {"position": [0, 3, 4], "target": [0, -1, 0], "fov_degrees": 50}
    floor = {"floor": {"kind": "studio", "shadow": 1, "colour": [1, 1, 1], "reflectance": 0}, "walls": {"kind": "none"}}
    lying = [{"position": [0, -0.373345, 0]}]
    parts = []
    for colour in (0.0, 0.2):
        sun = {**SUN, "colour": [colour] * 3}
        scene = scene_of(**floor, camera=camera, emitters=[sun, *LAMPS], stones=lying)
        light_map = bound(exact, scene, 0) if colour else None
        parts.append(radiance(take(exact, scene, size=SIZE, light_map=light_map)))
    scene = scene_of(**floor, camera=camera, emitters=[{**SUN, "colour": [0.2] * 3}, *LAMPS], stones=lying)
    even, _ = studio_light(staged(scene), np.zeros(3))
    assert ((even > 0.1) & (even < 0.9)).all()
    seen = ~look_around(scene, shape_of(scene.stones[0], {}), *SIZE).stone & (parts[0][..., 0] < 1)
    assert (parts[0][seen] < 0.7).any()
    assert parts[1][seen] == pytest.approx(1 - even * (1 - parts[0][seen]), abs=1e-9)


WITHOUT: dict[str, dict[str, Any]] = {
    "no matte surface": {"floor": {"kind": "mirror"}, "walls": {"kind": "none"}},
    "no surface": {"floor": {"kind": "none"}, "walls": {"kind": "none"}},
    "no stone": {"stones": []},
    "no lamp": {"emitters": []},
    "black lamps": {"emitters": [{**SUN, "colour": [0, 0, 0]}]},
    "lamps below the floor": {"emitters": [{**SUN, "direction": [0, -1, 0.2]}], "walls": {"kind": "none"}},
    "lamps behind the walls": {"emitters": [{**SUN, "direction": [0, 1, -0.5]}]},
    "a sky that hides its lamps": {"environment": {"kind": "dark"}, "emitters": [SUN]},
    "the report's estimator": {"optics": {"estimator": "classic"}},
    "a studio floor under wide lamps": {**STUDIO, "emitters": LAMPS},
    "sharp shadows of one stone alone": {"optics": {"caustics": "off"}, "emitters": [POINT]},
}
WITH: dict[str, tuple[dict[str, Any], tuple[int, ...]]] = {
    "matte room": ({}, (0, 1, 2, 3)),
    "matte floor": ({"walls": {"kind": "mirror"}}, (0,)),
    "matte walls": ({"floor": {"kind": "mirror"}}, (1, 2, 3)),
    "shadows of a sun": ({"optics": {"caustics": "off"}, "emitters": [SUN, POINT]}, (0, 1, 2, 3)),
    "shadows of two stones": (
        {"optics": {"caustics": "off"}, "emitters": [POINT], "stones": [{}, {"id": "b"}]},
        (0, 1, 2, 3),
    ),
    "shadows on a studio floor": ({**STUDIO, "optics": {"caustics": "off"}, "emitters": [POINT]}, (0,)),
    "wide lamps": ({"emitters": LAMPS, "walls": {"kind": "none"}}, (0,)),
    "a studio floor under a sun": (STUDIO, (0,)),
    "a studio floor under a point": ({**STUDIO, "emitters": [POINT]}, (0,)),
}


@pytest.mark.parametrize("fields", WITHOUT.values(), ids=WITHOUT.keys())
def test_where_nothing_can_be_thrown_the_program_holds_no_map(fields: dict[str, Any]) -> None:
    stage = staged(scene_of(**fields))
    assert mapped_surfaces(stage) == ()
    assert features_of(stage).light_map == 0
    assert "-DLIGHT_MAP=0" in features_of(stage).options


@pytest.mark.parametrize(("fields", "mapped"), WITH.values(), ids=WITH.keys())
def test_where_shadows_can_be_seen_there_is_one(fields: dict[str, Any], mapped: tuple[int, ...]) -> None:
    stage = staged(scene_of(**fields))
    assert mapped_surfaces(stage) == mapped
    assert features_of(stage).light_map == RUNTIME


@pytest.mark.parametrize("name", [name for name in PRESETS if name not in ("matte", "heap")])
def test_presets_without_a_matte_floor_or_a_small_lamp_have_none(name: str) -> None:
    stage = staged(PRESETS[name].scene)
    assert (features_of(stage).light_map == 0) is (name not in ("sun", "window"))


def test_without_a_map_the_program_shows_the_same_whether_it_could_read_one(exact: Renderer) -> None:
    """Points' shadows are then looked for by rays, as the program without maps does."""
    scene = scene_of(emitters=[POINT])
    programs = Features(), Features(light_map=0)
    general, without = (radiance(take(exact, scene, size=SIZE, features=features)) for features in programs)
    assert general == pytest.approx(without, abs=1e-12)
