"""Floor, walls, lights, shadows, mirrors and skies, against a second account of them in numpy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.rendering.features import Features, Geometry
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import Scene
from culet.scene.legacy import LEGACY_LAMPS, legacy
from pictures import compared
from rendering.room_reference import Seen, look_around
from rendering.views import radiance, take

SIZE = 96, 54
FINE = {"cutoff": 1e-9}
"""Light in mirrors is followed to a tenth of the cut-off."""
WIDE: dict[str, Any] = {
    "camera": {"position": [0.7, 1.5, 5], "target": [0.2, 0, -2], "fov_degrees": 75},
    "optics": FINE,
}
SKIES: dict[str, dict[str, Any]] = {
    "dark": {"kind": "dark"},
    "light": {"kind": "light"},
    "constant": {"kind": "constant", "radiance": [0.1, 2, 3]},
    "half": {"kind": "half", "radiance": [3, 2, 1]},
    "gradient": {"kind": "gradient", "bottom": [1, 0, 0.5], "top": [0, 2, 0.5]},
    "studio": {"kind": "studio"},
}
ROOMS = [(floor, walls) for floor in ("none", "matte", "mirror") for walls in ("none", "matte", "mirror")]


PAINTED: dict[str, dict[str, Any]] = {
    "coloured": {
        "floor": {"kind": "matte", "albedo": [0.1, 0.5, 0.9], "checker": {"albedo": [0.9, 0.2, 0], "cell": 2.7}},
    },
    "plain": {"floor": {"kind": "matte", "albedo": [0.4, 0.4, 0.3], "checker": "off"}},
    "walls of their own": {
        "floor": {"kind": "matte"}, "walls": {"kind": "matte", "albedo": [0.3, 0.2, 0.1], "checker": {"cell": 0.4}},
    },
    "for matte surfaces alone": {"floor": {"kind": "mirror", "albedo": [0, 1, 0], "checker": "off"}},
}  # fmt: skip


def compare(renderer: Renderer, scene: Scene, stone: Shape | None, tolerance: float, doubtful: int) -> None:
    """Pixels that see the room alone agree, but for those whose ray meets a checker's or a shadow's edge."""
    agree(take(renderer, scene, stone, SIZE), look_around(scene, stone, *SIZE), tolerance, doubtful)


def agree(picture: DevicePicture, expected: Seen, tolerance: float, doubtful: int) -> None:
    """But for so many pixels, whose rays meet an edge."""
    seen, room = radiance(picture), ~expected.stone
    assert room.mean() > 0.3
    difference = abs(seen - expected.radiance).max(axis=-1)[room]
    with compared(np.where(room[..., None], seen, 0), np.where(room[..., None], expected.radiance, 0)):
        assert (difference > tolerance).sum() <= doubtful


@pytest.mark.parametrize("environment", SKIES.values(), ids=SKIES.keys())
def test_every_sky_is_as_described(exact: Renderer, environment: dict[str, Any]) -> None:
    """In all directions: 170 degrees towards the studio's lamps, and its half sky to both sides of the horizon."""
    camera = {"position": [0, 0, 0], "target": [0.1, 0.6, 0.3], "fov_degrees": 150}
    scene = legacy({"stones": [], "floor": {"kind": "none"}, "environment": environment, "camera": camera})
    compare(exact, scene, None, 5e-12, 0)  # measured 1.1e-12, the studio; 5e-16 the others


SUN = {"shape": "sun", "direction": [0.1, 0.6, 0.3], "colour": [1e-3, 2e-3, 3e-3], "half_angle_degrees": 4}
BOX = {
    "shape": "box", "direction": [0.5, 0.6, 0.3], "radiance": [1, 2, 3],
    "half_width_degrees": 9, "half_height_degrees": 14,
}  # fmt: skip


@pytest.mark.parametrize("kind", ["constant", "half", "gradient", "studio", "dark", "light"])
def test_lamps_and_suns_are_seen_before_any_sky_but_the_reports(exact: Renderer, kind: str) -> None:
    """A sun's radiance is such that a surface which faces it gets pi times its colour, by quadrature."""
    camera = {"position": [0, 0, 0], "target": [0.1, 0.6, 0.3], "fov_degrees": 90}
    common = {"stones": [], "floor": {"kind": "none"}, "environment": {"kind": kind}, "camera": camera}
    scene, bare = (legacy({**common, "emitters": emitters}) for emitters in ([SUN, BOX], []))
    compare(exact, scene, None, 1e-9, 0)  # measured between 1e-10 and 1e-9: the quadrature
    seen = radiance(take(exact, scene, None, SIZE)) - radiance(take(exact, bare, None, SIZE))
    assert (seen.max() > 0.1) == (kind not in ("dark", "light"))


@pytest.mark.parametrize(("floor", "walls"), ROOMS)
def test_every_room_is_as_described(renderer: Renderer, exact: Renderer, floor: str, walls: str) -> None:
    """Without a stone: checkers, both lights, mirrors in mirrors."""
    scene = legacy({**WIDE, "stones": [], "floor": {"kind": floor}, "walls": {"kind": walls}})
    compare(exact, scene, None, 5e-12, 0)  # measured 1.9e-12, a lamp's edge
    compare(renderer, scene, None, 1e-3, 40)  # of 5184: lamps' edges, up to 7e-4; the far checker's edges


@pytest.mark.parametrize("painted", PAINTED.values(), ids=PAINTED.keys())
def test_surfaces_have_the_albedo_and_the_checker_that_the_scene_says(exact: Renderer, painted: dict[str, Any]) -> None:
    compare(exact, legacy({**WIDE, "stones": [], **painted}), None, 5e-12, 0)


def test_a_mirror_floor_returns_four_fifths_of_the_sky_and_a_fifth_of_its_own_light(exact: Renderer) -> None:
    """The closed form under an even sky: (0.8 + 0.2 x albedo) sky, albedo 0.1 and 0.05."""
    data = {"stones": [], "emitters": [], "environment": {"kind": "constant", "radiance": [1, 2, 4]}}
    camera = {"position": [0, 3, 0], "target": [0.5, -1, 0.5], "fov_degrees": 50}
    pixels = radiance(take(exact, legacy({**data, "camera": camera}))).reshape(-1, 3)
    expected = np.array([[(0.8 + 0.2 * albedo) * c for c in (1, 2, 4)] for albedo in (0.1, 0.05)])
    distance = abs(pixels[:, None, :] - expected).max(axis=-1)
    assert distance.min(axis=1).max() < 1e-14
    assert (distance < 1e-14).mean(axis=0).min() > 0.3  # both kinds of cell are seen


def test_a_mirrored_camera_sees_the_mirrored_stone(exact: Renderer) -> None:
    """A stone seen from below, through no floor, is what the mirror shows of it from above, times 0.8.

    The mirror's own light is known, and the stone in the open sees no floor, so its light may not come by way of the
    mirror: a stone of index 1 that absorbs does neither reflect nor refract, and shows the sky behind it.
    """
    stone = {"material": {"ior": [1, 1, 1]}, "absorption": [0.5, 1, 2], "position": [0, 1, 0]}
    sky = {"kind": "gradient", "bottom": [0.2, 0.3, 0.4], "top": [1, 2, 3]}
    common = {"stones": [stone], "emitters": [], "environment": sky, "optics": FINE}
    above = {"position": [0, 2, 4], "target": [0, -2.9, -0.2], "fov_degrees": 25}
    below = {"position": [0, -4, 4], "target": [0, 0.9, -0.2], "up": [0, -1, 0], "fov_degrees": 25}
    mirrored = radiance(take(exact, legacy({**common, "camera": above})))
    direct = radiance(take(exact, legacy({**common, "camera": below, "floor": {"kind": "none"}})))[:, ::-1]
    floor = look_around(legacy({**common, "camera": above, "stones": []}), None, *SIZE).radiance
    bare = look_around(legacy({**common, "camera": below, "stones": [], "floor": {"kind": "none"}}), None, *SIZE)
    own = floor - 0.8 * bare.radiance[:, ::-1]  # the mirror's own light
    with compared(mirrored, 0.8 * direct + own):
        assert mirrored == pytest.approx(0.8 * direct + own, abs=1e-12)
    assert (abs(direct - bare.radiance[:, ::-1]).max(axis=-1) > 0.1).mean() > 0.05  # the stone is in view


def lit(*points: dict[str, Any]) -> dict[str, Any]:
    """The legacy lamps, with these point lights."""
    return {"emitters": [*(lamp.model_dump() for lamp in LEGACY_LAMPS), *({"shape": "point", **p} for p in points)]}


LIGHTS: dict[str, dict[str, Any]] = {
    "two above": {},
    "low": lit({"position": [-3, -0.5, 1], "colour": [1, 1, 1]}),
    "near": lit({"position": [0.3, 1.9, 0.2], "colour": [1, 1, 1]}),
    "inside the stone": lit({"position": [0.1, 0.75, 0], "colour": [1, 1, 1]}),
    "under the stone": lit({"position": [0.2, -0.5, 0.1], "colour": [1, 1, 1]}),
    "below the floor": lit({"position": [0, -3, 0], "colour": [1, 1, 1]}),
    "in the floor": lit({"position": [2, -1, 0], "colour": [1, 1, 1]}),
    "far": lit({"position": [-1e6, 2e6, 5e5], "colour": [1, 1, 1]}),
    "eight": lit(*({"position": [4 - i, 3, i], "colour": [0.1 * i, 0.5, 1]} for i in range(8))),
}
PLACES: dict[str, dict[str, Any]] = {
    "hovering": {"position": [0, 0.8, 0]},
    "through the floor": {"position": [0.3, -1.1, 0]},
    "lying at the wall": {"position": [0, -0.6, -7.5]},
}


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES.keys())
def test_shadows_lie_where_the_stone_is_in_the_way(
    exact: Renderer, light: dict[str, Any], place: dict[str, Any]
) -> None:
    """Shadow volumes against clipping each pixel's segment to the light: floor and walls, seen past the stone."""
    x, _, z = place["position"]
    camera = {"position": [x, 5, z + 5], "target": [x, -1, z], "fov_degrees": 60}
    data = {"floor": {"kind": "matte"}, "walls": {"kind": "matte"}, "camera": camera, "stones": [place], "optics": FINE}
    scene = legacy({**data, **light})
    compare(exact, scene, shape_of(scene.stones[0], {}), 1e-11, 0)


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES.keys())
def test_a_tree_of_triangles_casts_the_same_shadows(exact: Renderer, place: dict[str, Any]) -> None:
    """The same stone with its facets as triangles; the edge of a shadow may fall to either side."""
    x, _, z = place["position"]
    camera = {"position": [x, 5, z + 5], "target": [x, -1, z], "fov_degrees": 60}
    scene = legacy({"floor": {"kind": "matte"}, "camera": camera, "stones": [place], "optics": FINE})
    by_planes, by_triangles = (
        radiance(take(exact, scene, size=SIZE, features=Features(geometry)))
        for geometry in (Geometry.HULL, Geometry.MESH)
    )
    with compared(by_planes, by_triangles):
        assert (abs(by_planes - by_triangles).max(axis=-1) > 1e-9).sum() <= 2


def test_a_mirror_shows_the_stones_shadow(exact: Renderer) -> None:
    """Pixels that see the floor's shadow by way of a mirror wall."""
    camera = {"position": [0, 1, 4], "target": [0, 0.3, -8], "fov_degrees": 60}
    data = {"floor": {"kind": "matte"}, "walls": {"kind": "mirror"}, "camera": camera, "optics": FINE}
    scene = legacy({**data, "stones": [{"position": [0, 0.2, -4]}]})
    compare(exact, scene, shape_of(scene.stones[0], {}), 1e-11, 0)


def crowd(ior: float) -> list[dict[str, Any]]:
    """Twelve stones by chance: through the floor, through the wall, in the air, some within another; so many that they
    are in two groups."""
    random = np.random.default_rng(7)
    return [
        {
            "id": f"s{number}",
            "material": {"ior": [ior] * 3},
            "position": [*(random.random(3) * [6, 2.2, 3.4] + [-3, -1.3, -8.3])],
            "orientation": [*random.normal(size=4)],
            "scale": random.uniform(0.2, 0.8),
        }
        for number in range(12)
    ]


@pytest.mark.parametrize("light", ["low", "below the floor", "eight"])
def test_each_of_many_stones_shades_and_is_hidden_as_it_would_be_alone(
    renderer: Renderer, exact: Renderer, light: str
) -> None:
    """On floor and walls. What is seen of the stones is told by their material, which nothing else depends on."""
    room = {"floor": {"kind": "matte"}, "walls": {"kind": "matte"}, "optics": FINE | {"max_bounces": 1}}
    camera = {"position": [0.5, 2, 0], "target": [0, -0.6, -7], "fov_degrees": 50}
    glass, dense = (legacy({**room, **LIGHTS[light], "camera": camera, "stones": crowd(ior)}) for ior in (1.5, 2.4))
    shape = shape_of(glass.stones[0], {})
    expected = look_around(glass, shape, *SIZE)
    agree(take(exact, glass, shape, SIZE), expected, 1e-11, 0)
    agree(take(renderer, glass, shape, SIZE), expected, 1e-3, 40)  # of 5184: edges
    one, other = (radiance(take(exact, scene, shape, SIZE)) for scene in (glass, dense))
    assert ((one != other).any(axis=-1) == expected.stone).all()
