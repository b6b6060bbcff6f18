"""Soft boxes, the observer's head, the backdrop and the studio floor, against a second account of them in numpy.

A scene that has none of them pays nothing.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from conftest import RendererOf
from culet.geometry.load import shape_of
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.optics.panoramas import directions
from culet.rendering.emitters.unshaded import sky_light
from culet.rendering.features import ESTIMATOR, Features, features_of, geometry_of
from culet.rendering.renderer import Renderer
from culet.rendering.room.studio import LEAST_SHADE, contact_forms
from culet.rendering.stones.placed_stone import placed_stones, rotation_matrix
from culet.scene import PRESETS, Scene
from culet.scene.legacy import LEGACY_DEFAULT, legacy
from optics.closed_forms import fresnel
from rendering.room_reference import passes_through, sky, span, world_half_spaces
from rendering.views import BARE, UPRIGHT, Array, pixel_directions, radiance, take
from shared.stages import staged
from shared.stones import slab

SIZE = 96, 54
BOXES = [
    {"shape": "box", "direction": [0.3, 0.7, 0.6], "half_width_degrees": 14, "half_height_degrees": 20,
     "radiance": [1, 2, 3], "fade": 0.5, "softness": 0.4},
    {"shape": "box", "direction": [-0.8, 0.2, 0.5], "half_width_degrees": 50, "half_height_degrees": 4,
     "radiance": [0.5, 0.4, 0.3]},
    {"shape": "round", "direction": [0, 0.4, 1], "half_angle_degrees": 6, "radiance": [4, 5, 6]},
]  # fmt: skip
STUDIO: dict[str, Any] = {"kind": "studio", "ambient": [0.1, 0.2, 0.3]}
OFF = {"boxes": 0, "head": 0, "backdrop": 0, "glare": 1}
BEFORE = np.load(Path(__file__).parent / "legacy_default.npz")
"""`LEGACY_DEFAULT` in double precision, 96 x 54: as version 0.1 drew it, but that lamps light the mirror's own checker
in place of a constant, 0.006 brighter at most."""


def shown(
    renderer: Renderer, scene: Scene, stone: Shape | None = None, size: tuple[int, int] = SIZE, samples: int = 1
) -> Array:
    """The picture by the general program, which is compiled once for all."""
    shapes = [stone] if stone is not None and scene.stones else []
    features = Features(geometry_of(shapes), estimator=ESTIMATOR[scene.optics.estimator])
    return radiance(take(renderer, scene, stone, size, samples, features))


def scene_of(**fields: object) -> Scene:
    """A bare room under `STUDIO`, without head and backdrop, but for what is given."""
    base: dict[str, Any] = {**BARE, "stones": [], "optics": {"cutoff": 1e-9}}
    if "environment" not in fields:
        base |= {"environment": STUDIO, "emitters": BOXES}
    camera = {"position": [0.7, 1.5, 5], "target": [0.2, 0, -2], "fov_degrees": 75}
    return legacy({**base, "camera": camera, **fields})


def floor_points(scene: Scene) -> tuple[Array, Array]:
    """(pixels, 3) where the pixels' rays meet the floor, and their directions; NaN above the horizon."""
    d = pixel_directions(scene, *SIZE).reshape(-1, 3)
    eye = np.array(scene.camera.position)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(d[:, 1] < 0, -(eye[1] + 1) / d[:, 1], np.nan)
    return eye + t[:, None] * d, d


@pytest.mark.parametrize("name", ["legacy", *PRESETS])
def test_a_scene_that_asks_for_none_of_it_has_a_program_without_it(name: str, brilliant: Shape) -> None:
    scene = LEGACY_DEFAULT if name == "legacy" else PRESETS[name].scene
    asks = scene.head is not None or scene.backdrop.kind != "none" or not scene.optics.glare
    features = features_of(staged(scene, brilliant))
    found = {feature: getattr(features, feature) for feature in OFF}
    assert (found == OFF) is not (asks or any(lamp.shape == "box" for lamp in scene.shown_lamps))


def test_the_legacy_default_is_drawn_as_before(exact: Renderer, brilliant: Shape) -> None:
    """To the bit on the same machine; another processor rounds at edges otherwise."""
    picture = take(exact, LEGACY_DEFAULT, brilliant, SIZE)
    assert radiance(picture) == pytest.approx(BEFORE["radiance"], abs=1e-6)
    assert picture.segments() == pytest.approx(BEFORE["segments"], rel=1e-4)


def test_boxes_are_seen_as_described(renderer: Renderer, exact: Renderer) -> None:
    scene = scene_of(camera={"position": [0, 0, 0], "target": [-0.1, 0.4, 1], "fov_degrees": 150})
    expected = sky(scene, pixel_directions(scene, *SIZE).reshape(-1, 3)).reshape(SIZE[1], SIZE[0], 3)
    assert (expected.max(axis=(0, 1)) > 1).all()
    assert shown(exact, scene) == pytest.approx(expected, abs=1e-11)  # measured 2e-12
    assert shown(renderer, scene) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("turn", [90, -270])
def test_a_turned_box_is_as_wide_as_it_was_high(exact: Renderer, turn: float) -> None:
    camera = {"position": [0, 0, 0], "target": [0.3, 0.7, 0.6], "fov_degrees": 80}
    box = {**BOXES[0], "fade": 0}
    turned = {**box, "half_width_degrees": 20, "half_height_degrees": 14, "turn_degrees": turn}
    pictures = [shown(exact, scene_of(camera=camera, emitters=[lamp])) for lamp in (box, turned)]
    assert pictures[1] == pytest.approx(pictures[0], abs=1e-12)


BACKDROPS: dict[str, dict[str, Any]] = {
    "plain": {"kind": "plain", "colour": [0.1, 0.2, 0.3]},
    "gradient": {"kind": "gradient", "centre": [0.5, 0.4, 0.3], "edge": [0.1, 0, 0.2], "focus": [0.3, -0.1]},
}


def backdrop_of(scene: Scene) -> Array:
    """(height, width, 3) by its definition, in heights of the picture from the middle."""
    width, height = SIZE
    found: Any = scene.backdrop
    if found.kind == "plain":
        return np.tile(found.colour, (height, width, 1))
    x = (np.arange(width) + 0.5 - width / 2) / height - found.focus[0]
    y = (height / 2 - np.arange(height) - 0.5) / height - found.focus[1]
    part = np.minimum(np.hypot(x[None, :] / found.size[0], y[:, None] / found.size[1]), 1)
    share = (3 * part**2 - 2 * part**3)[..., None]
    return np.asarray((1 - share) * np.array(found.centre) + share * np.array(found.edge))


@pytest.mark.parametrize("backdrop", BACKDROPS.values(), ids=BACKDROPS.keys())
@pytest.mark.parametrize("floor", ["none", "studio"])
@pytest.mark.parametrize("estimator", ["chain", "classic"])
def test_the_camera_sees_the_backdrop_and_no_lamp(
    exact: Renderer, backdrop: dict[str, Any], floor: str, estimator: str
) -> None:
    """Without a horizon, where the floor is a studio's."""
    optics = {"estimator": estimator, "fresnel": "schlick"}
    scene = scene_of(backdrop=backdrop, floor={"kind": floor}, optics=optics)
    assert shown(exact, scene) == pytest.approx(backdrop_of(scene), abs=1e-12)


def test_a_mirror_floor_shows_the_backdrop_too(exact: Renderer) -> None:
    """Four fifths of it, and of the mirror's own light, which is the sky's, a fifth times 0.1 or 0.05."""
    scene = scene_of(backdrop=BACKDROPS["plain"], floor={"kind": "mirror"})
    seen = shown(exact, scene)
    points, _ = floor_points(scene)
    below = np.isfinite(points[:, 0]).reshape(SIZE[1], SIZE[0])
    assert 0.2 < below.mean() < 0.9
    light = sky_light(staged(scene))[0]
    expected = np.array([0.8 * np.array((0.1, 0.2, 0.3)) + 0.2 * albedo * light for albedo in (0.05, 0.1)])
    assert abs(seen[below][:, None] - expected).max(axis=-1).min(axis=1).max() < 1e-12
    assert seen[~below] == pytest.approx(np.tile((0.1, 0.2, 0.3), ((~below).sum(), 1)), abs=1e-12)


def test_what_stones_see_is_no_backdrop(exact: Renderer, brilliant: Shape) -> None:
    """The stone's pixels are those without it; all others differ."""
    stone = {"stones": [{**UPRIGHT}]}
    plain = {"backdrop": {"kind": "plain", "colour": [7, 7, 7]}}
    without, behind = (shown(exact, scene_of(**stone, **more), brilliant) for more in ({}, plain))
    same = (without == behind).all(axis=-1)
    planes, eye = world_half_spaces(scene_of(**stone), brilliant), np.array(scene_of().camera.position)
    d = pixel_directions(scene_of(), *SIZE).reshape(-1, 3)
    meets = passes_through(planes, np.tile(eye, (len(d), 1)), d).reshape(SIZE[1], SIZE[0])
    assert (same == meets).all()
    assert meets.sum() > 50


def test_a_head_as_bright_as_the_sky_is_not_seen(exact: Renderer, brilliant: Shape) -> None:
    constant = {"kind": "constant", "radiance": [0.5, 1, 2]}
    plain, headed = (
        shown(exact, scene_of(stones=[{}], environment=constant, head=head), brilliant)
        for head in (None, {"half_angle_degrees": 30, "radiance": [0.5, 1, 2]})
    )
    assert headed == pytest.approx(plain, abs=1e-12)


def test_the_head_hides_the_sky_around_the_camera_from_stones_alone(exact: Renderer, brilliant: Shape) -> None:
    """From below, a head of 90 degrees is all that is under the horizon: what is left is `half`, lit from above. The
    camera itself sees the sky, below too."""
    camera = {"position": [0, -40, 0.001], "target": [0, 0, 0], "fov_degrees": 4}
    common: dict[str, Any] = {"stones": [{**UPRIGHT}], "camera": camera}
    head = {"half_angle_degrees": 90, "radiance": [0, 0, 0], "softness": 0.02}
    headed = shown(exact, scene_of(**common, environment={"kind": "constant"}, head=head), brilliant)
    half = shown(exact, scene_of(**common, environment={"kind": "half"}), brilliant)
    stone = (half != half[0, 0]).any(axis=-1)
    assert stone.mean() > 0.2
    assert (headed[~stone] == 1).all()
    # light that leaves within 1.8 degrees of the horizon falls into the head's soft edge
    assert abs(headed - half)[stone].mean() < 0.01  # measured 0.0016
    assert (abs(headed - half)[stone].max(axis=-1) < 1e-6).mean() > 0.7  # measured 0.78


def test_the_head_follows_the_camera(exact: Renderer, brilliant: Shape) -> None:
    """The whole scene turned about the vertical, camera included: the same picture."""
    head = {"half_angle_degrees": 25}
    pictures = []
    for x, z, spin in ((0.0, 8.0, (1, 0, 0, 0)), (8.0, 0.0, (np.sqrt(0.5), 0, np.sqrt(0.5), 0))):
        scene = scene_of(
            stones=[{"position": [0, 0, 0], "orientation": spin}],
            camera={"position": [x, 6, z], "target": [0, 0, 0], "fov_degrees": 14},
            environment={"kind": "constant"},
            head=head,
        )
        pictures.append(shown(exact, scene, brilliant))
    assert pictures[1] == pytest.approx(pictures[0], abs=1e-9)
    assert pictures[0].min() < 0.5


def test_a_studio_as_a_panorama_shows_the_same_stone(renderer: Renderer, brilliant: Shape) -> None:
    """All of it painted into a picture of all directions by numpy: lamps, boxes, the head, the floor's colour."""
    common: dict[str, Any] = {
        "stones": [{"position": [0, 0.5, 0]}],
        "camera": {"position": [0, 8, 11], "target": [0, 0.5, 0], "fov_degrees": 10},
    }
    head = {"half_angle_degrees": 14, "radiance": [0.02, 0.02, 0.02]}
    studio = scene_of(**common, floor={"kind": "studio", "colour": [0.3, 0.2, 0.1], "reflectance": 0}, head=head)
    d = directions(1024)
    painted = sky(studio, d.reshape(-1, 3)).reshape(d.shape)
    towards = np.array([0, 7.5, 11]) / np.hypot(7.5, 11)
    rim, full = np.cos(np.radians(14 * np.array([1, 0.7])))
    s = np.clip((d @ towards - rim) / (full - rim), 0, 1)
    painted += (3 * s**2 - 2 * s**3)[..., None] * (0.02 - painted)
    painted[d[..., 1] < 0] = (0.3, 0.2, 0.1)
    image = scene_of(**common, environment={"kind": "image"})
    picture = renderer.picture(staged(image, brilliant, painted.astype(np.float32)), *SIZE)
    picture.refine()
    seen, expected = shown(renderer, studio, brilliant), radiance(picture)
    planes = world_half_spaces(studio, brilliant)
    eye = np.tile(np.array(studio.camera.position), (SIZE[0] * SIZE[1], 1))
    stone = passes_through(planes, eye, pixel_directions(studio, *SIZE).reshape(-1, 3)).reshape(SIZE[1], SIZE[0])
    assert stone.mean() > 0.2
    apart = abs(seen - expected)[stone]
    assert np.median(apart) < 2e-3  # measured 4e-4: a panorama's pixels are 0.18 degrees
    assert apart.mean() < 0.01 * expected[stone].mean()  # measured 0.4 %


def test_the_floor_shows_a_stone_by_its_reflectance_and_height(exact: Renderer, brilliant: Shape) -> None:
    """A stone of index 1 does not change light, so that what the floor mirrors of it is the sky behind it, of radiance
    1: on a black floor each such pixel shows reflectance e^(-height / fade)."""
    floor = {"kind": "studio", "colour": [0, 0, 0], "reflectance": 0.5, "fade": 0.7, "shadow": 0}
    scene = scene_of(
        stones=[{"position": [0, 0, 0], "material": {"ior": [1, 1, 1]}}],
        environment={"kind": "constant"},
        camera={"position": [0, 6, 8], "target": [0, -0.5, 0], "fov_degrees": 24},
        floor=floor,
    )
    seen = shown(exact, scene, brilliant)[..., 0].ravel()
    points, d = floor_points(scene)
    planes = world_half_spaces(scene, brilliant)
    eye = np.tile(np.array(scene.camera.position), (len(d), 1))
    mirrored = d * (1, -1, 1)
    covered = ~passes_through(planes, eye, d) & passes_through(planes, points, mirrored)
    gap, speed = planes[:, 3] - points @ planes[:, :3].T, mirrored @ planes[:, :3].T
    t = np.where(speed < 0, gap / speed, -np.inf).max(axis=1)
    expected = 0.5 * np.exp(-t * mirrored[:, 1] / 0.7)
    assert covered.sum() > 150
    assert seen[covered] == pytest.approx(expected[covered], abs=1e-7)  # measured 2e-8: the weight below 1e-9 is cut
    bare = ~covered & ~passes_through(planes, eye, d)
    assert (seen[bare] == 0).all()


def test_more_samples_soften_the_reflection_far_above_the_floor(renderer: Renderer, brilliant: Shape) -> None:
    """The first sample is sharp; the mean of many is that of a floor tilted to all sides."""
    camera = {"position": [0, 6, 8], "target": [0, -0.5, 0], "fov_degrees": 24}
    common: dict[str, Any] = {"stones": [{"position": [0, 0.2, 0]}], "camera": camera}
    by_roughness = {
        roughness: shown(renderer,
                scene_of(**common, floor={"kind": "studio", "colour": [0, 0, 0], "roughness": roughness, "shadow": 0}),
                brilliant, (192, 108), samples,
            )
        for roughness, samples in ((0.0, 32), (0.05, 32))
    }  # fmt: skip
    reflection = np.s_[70:, 60:130]
    sharp, soft = (abs(np.diff(picture[reflection].sum(axis=-1), axis=0)).mean() for picture in by_roughness.values())
    assert soft < 0.7 * sharp
    assert by_roughness[0.05][reflection].mean() == pytest.approx(by_roughness[0.0][reflection].mean(), rel=0.1)


def sky_kept_away(planes: Array, points: Array, directions_: int = 4000) -> Array:
    """(N,) part of an even sky's light on the floor that a convex body keeps away, by directions spread evenly over the
    disc below the hemisphere (Malley's method)."""
    k = np.arange(directions_) + 0.5
    radius, angle = np.sqrt(k / directions_), k * np.pi * (3 - np.sqrt(5))
    d = np.stack([radius * np.cos(angle), np.sqrt(1 - radius**2), radius * np.sin(angle)], axis=-1)
    return np.array([passes_through(planes, np.tile(point, (len(d), 1)), d).mean() for point in points])


def shown_shadow(exact: Renderer, scene: Scene, stone: Shape) -> tuple[Array, Array]:
    """(N, 3) points of the floor around the stone that the camera sees, and the part of their light that is missing."""
    seen = 1 - shown(exact, scene, stone)[..., 0].ravel()
    points, d = floor_points(scene)
    eye = np.tile(np.array(scene.camera.position), (len(d), 1))
    stone_is = passes_through(world_half_spaces(scene, stone), eye, d)
    near = ~stone_is & (np.hypot(points[:, 0], points[:, 2]) < 3)
    return points[near][::23], seen[near][::23]


SHADOWED: dict[str, Any] = {
    "environment": {"kind": "constant"},
    "floor": {"kind": "studio", "colour": [1, 1, 1], "reflectance": 0, "shadow": 1},
    "camera": {"position": [0, 6, 8], "target": [0, -0.8, 0], "fov_degrees": 30},
}


def test_the_contact_shadow_of_a_ball_is_that_of_an_even_sky(exact: Renderer) -> None:
    """The ball is whole above each point's horizon, so that it keeps away height x radius^2 / distance^3 of the light
    (plane element to sphere, Howell's catalogue of configuration factors). What is darker is led towards all of it."""
    ball = shape_from_mesh(trimesh.creation.icosphere(4).export(file_type="obj").encode(), "obj", name="ball.obj")
    middle = np.array([0, 0.3, 0])
    points, seen = shown_shadow(exact, scene_of(**SHADOWED, stones=[{"position": middle.tolist()}]), ball)
    truth = 1.3 / np.linalg.norm(middle - points, axis=1) ** 3
    assert truth.max() > 0.4
    assert abs(seen - truth).max() < 0.03  # measured 0.009


def test_the_contact_shadow_of_a_brilliant_at_rest_is_near_that_of_an_even_sky(
    exact: Renderer, brilliant: Shape
) -> None:
    scene = scene_of(**SHADOWED, stones=[{"position": [0, -0.373345, 0]}])
    points, seen = shown_shadow(exact, scene, brilliant)
    truth = sky_kept_away(world_half_spaces(scene, brilliant), points)
    assert truth.max() > 0.2  # what is darker is hidden by the stone
    assert abs(seen - truth).mean() < 0.05
    assert abs(seen - truth).max() < 0.25


def form(scene: Scene, shape: Shape) -> Array:
    (stone,) = placed_stones(staged(scene, shape))
    return np.asarray(contact_forms([stone])[0])


def test_the_shadows_ellipsoid_has_the_stones_moments(brilliant: Shape) -> None:
    """A slab's: second moments of a box are a third of its half widths squared (uniform density)."""
    plate = slab(0.3)
    half = np.array([np.sqrt((1 - 0.09) / 2), 0.3, np.sqrt((1 - 0.09) / 2)])
    spread = np.diag(5 * half**2 / 3)
    expected = np.linalg.det(spread) * np.linalg.inv(spread)
    assert form(scene_of(stones=[{**UPRIGHT}]), plate) == pytest.approx(expected, rel=1e-9)
    turned = scene_of(stones=[{}])
    rotation = rotation_matrix(turned.stones[0].orientation)
    upright = form(scene_of(stones=[{**UPRIGHT}]), brilliant)
    assert form(turned, brilliant) == pytest.approx(rotation @ upright @ rotation.T, abs=1e-12)


def scattered(count: int) -> list[dict[str, Any]]:
    """Stones of index 1, which change no light, above the floor, of many sizes; more than eight are in two groups."""
    random = np.random.default_rng(5)
    return [
        {
            "id": f"s{number}",
            "material": {"ior": [1, 1, 1]},
            "position": [1.8 * (number % 4) - 2.7, random.uniform(-0.3, 0.3), 1.6 * (number // 4) - 2],
            "orientation": [*random.normal(size=4)],
            "scale": random.uniform(0.3, 0.7),
        }
        for number in range(count)
    ]


SCATTERED: dict[str, Any] = {
    "environment": {"kind": "constant"}, "camera": {"position": [0, 6, 9], "target": [0, -0.8, 0], "fov_degrees": 32},
}  # fmt: skip


def uncovered(scene: Scene) -> Array:
    """(pixels,) whether the camera sees past all stones."""
    d = pixel_directions(scene, *SIZE).reshape(-1, 3)
    eye = np.tile(np.array(scene.camera.position, float), (len(d), 1))
    covers = [
        passes_through(world_half_spaces(scene, shape_of(stone, {}), number), eye, d)
        for number, stone in enumerate(scene.stones)
    ]
    bare: Array = ~np.any(covers, axis=0)
    return bare


def test_of_several_stones_each_takes_its_part_of_the_light_that_the_others_leave_to_the_floor(exact: Renderer) -> None:
    floor = {"kind": "studio", "colour": [1, 1, 1], "reflectance": 0, "shadow": 0.8}
    stones = scattered(11)
    whole = scene_of(**SCATTERED, floor=floor, stones=stones)
    alone = [scene_of(**SCATTERED, floor=floor, stones=[stone]) for stone in stones]
    seen, *each = (radiance(take(exact, scene, size=SIZE))[..., 0].ravel() for scene in (whole, *alone))
    bare = uncovered(whole)
    expected = np.prod(each, axis=0)[bare]
    assert (expected < 0.8).sum() > 100
    assert abs(seen[bare] - expected).max() < len(stones) * LEAST_SHADE, "what is not worth a step is left out"
    one = np.array(each).min(axis=0)[bare]
    assert (one - expected).max() > 0.1, "somewhere several count"


def test_the_floor_shows_of_several_stones_the_one_that_its_mirror_would(exact: Renderer) -> None:
    """By the height at which the mirrored line of sight enters the first one."""
    floor = {"kind": "studio", "colour": [0, 0, 0], "reflectance": 0.5, "fade": 0.7, "shadow": 0}
    scene = scene_of(**SCATTERED, floor=floor, stones=scattered(11))
    seen = radiance(take(exact, scene, size=SIZE))[..., 0].ravel()
    points, d = floor_points(scene)
    mirrored = d * (1, -1, 1)
    first = np.full(len(d), np.inf)
    for number, stone in enumerate(scene.stones):
        enter, leave = span(world_half_spaces(scene, shape_of(stone, {}), number), points, mirrored)
        first = np.where((enter < leave) & (enter > 0), np.minimum(first, enter), first)
    bare = uncovered(scene)
    meets = np.isfinite(first)
    expected = np.where(meets, 0.5 * np.exp(-np.where(meets, first, 0) * mirrored[:, 1] / 0.7), 0)
    assert (expected[bare] > 0).sum() > 150
    assert seen[bare] == pytest.approx(expected[bare], abs=1e-7)


def test_without_glare_the_first_reflection_is_missing_and_nothing_else(exact: Renderer) -> None:
    """A plate of index 2 under an even sky of 1 shows 1; without its first reflection 1 - R."""
    plate = slab(0.4)
    common: dict[str, Any] = {
        "stones": [{**UPRIGHT, "material": {"ior": [2, 2, 2]}}],
        "environment": {"kind": "constant"},
        "camera": {"position": [0, 6, 4], "target": [0, 0, 0], "fov_degrees": 8},
    }
    with_glare, without = (
        shown(exact, scene_of(**common, optics={"cutoff": 1e-9, "glare": glare}), plate)[27, 48, 0]
        for glare in (True, False)
    )
    scene = scene_of(**common)
    cos_i = -pixel_directions(scene, *SIZE)[27, 48, 1]
    assert with_glare == pytest.approx(1, abs=1e-7)
    assert without == pytest.approx(1 - fresnel(float(np.sqrt(1 - cos_i**2)), 1, 2), abs=1e-7)


def test_parallel_rays_are_those_of_a_pinhole_far_away(exact: Renderer, brilliant: Shape) -> None:
    """From 1e5 R, where the angle between two rays is at most 3e-5."""
    away, height = 1e5, 3.0
    way = np.array([0, 0.6, 0.8])
    far = {"position": (away * way).tolist(), "target": [0, 0, 0], "fov_degrees": float(np.degrees(height / away))}
    near = {"kind": "orthographic", "position": (3 * way).tolist(), "target": [0, 0, 0], "height": height}
    pinhole, parallel = (
        shown(exact, scene_of(stones=[{**UPRIGHT}], camera=camera), brilliant) for camera in (far, near)
    )
    apart = abs(pinhole - parallel).max(axis=-1)
    assert np.median(apart) < 1e-4
    assert (apart > 0.01).mean() < 0.02  # edges of facets and lamps
    assert (parallel[27, 48] != parallel[0, 0]).any()


@pytest.mark.parametrize("distance", [-5.0, 0.0, 0.5, 2.0, 50.0])
def test_a_plane_of_parallel_rays_is_never_within_the_stone(exact: Renderer, brilliant: Shape, distance: float) -> None:
    """Wherever on the line of sight the camera is put, it shows the same stone."""
    pictures = [
        shown(
            exact,
            scene_of(
                stones=[{**UPRIGHT}],
                environment={"kind": "gradient"},
                camera={"kind": "orthographic", "position": [0, 0, at], "target": [0, 0, at - 1], "height": 2.5},
            ),
            brilliant,
        )
        for at in (10.0, distance)
    ]
    assert pictures[1] == pytest.approx(pictures[0], abs=1e-9)


EVERYTHING: dict[str, Any] = {
    "stones": [{"position": [0, -0.373345, 0]}],
    "camera": {"position": [0, 8.146, 11.032], "target": [0, -0.473, 0], "fov_degrees": 16},
    "floor": {"kind": "studio"},
    "backdrop": {"kind": "gradient"},
    "head": {"half_angle_degrees": 20},
    "optics": {"glare": False},
}


@pytest.mark.parametrize(
    "more", [{}, {"walls": {"kind": "matte"}}, {"walls": {"kind": "mirror"}}], ids=["", "matte", "mirror"]
)
def test_the_general_program_shows_the_same(renderer: Renderer, brilliant: Shape, more: dict[str, Any]) -> None:
    """Walls too: the studio floor is one of the room's surfaces then."""
    scene = scene_of(**EVERYTHING, **more)
    special = features_of(staged(scene, brilliant))
    own, general = (radiance(take(renderer, scene, brilliant, features=which)) for which in (special, Features()))
    apart = abs(own - general).max(axis=-1)
    assert (apart > 1e-6).mean() < 0.03  # measured 0 without walls, 0.008 among mirrors
    assert apart.max() < 1e-3  # measured 2.3e-4


@pytest.mark.parametrize("lanes", [1, 4, 8, 16])
def test_packets_of_any_width_show_the_same(
    renderer_of: RendererOf,
    exact: Renderer,
    brilliant: Shape,
    lanes: int,
) -> None:
    scene = scene_of(**EVERYTHING)
    expected = shown(exact, scene, brilliant)
    apart = abs(radiance(take(renderer_of(lanes, np.float32), scene, brilliant)) - expected).max(axis=-1)
    assert np.median(apart) < 1e-4
    assert (apart > 0.01).mean() < 0.02
