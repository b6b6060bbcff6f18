"""The room once more, from its description: floor, walls, checkers, lights, shadows, mirrors and skies, ray by ray.

Double precision, in the world's own coordinates, with shadows by clipping the segment to the light against each stone's
half-spaces: nothing here is shared with the kernels but the description.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.emitters.unshaded import sky_light
from culet.scene import Scene
from culet.scene.emitters import BoxLamp, PointLight, RoundLamp, Sun
from culet.scene.room import Floor, Plane
from culet.scene.sky import (
    ConstantEnvironment,
    Environment,
    GradientEnvironment,
    HalfEnvironment,
    LightEnvironment,
    StudioEnvironment,
)
from culet.stage import Stage
from rendering.views import Array, pixel_directions

SURFACES = np.array([[0, 1, 0, -1], [0, 0, 1, -8], [math.sqrt(3) / 2, 0, 0.5, -8], [-math.sqrt(3) / 2, 0, 0.5, -8]])
"""The room is n.x >= d; the floor comes first."""
MIRROR = 0.1, 0.05
"""Albedo of a mirror's even and odd cells, of 1 R."""


@dataclass(frozen=True, eq=False)
class Seen:
    radiance: Array
    """(..., 3)."""
    stone: NDArray[np.bool_]
    """Where the way of light meets the stone; the radiance is not told there."""


def box_share(box: BoxLamp, direction: Array) -> Array:
    """(N,) radiance of an upright soft box in parts of its own: by the angles from each direction to the planes through
    the eye and the box's edges, and by its height within the box."""
    assert box.turn_degrees == 0
    middle = np.array(box.direction) / np.linalg.norm(box.direction)
    right = np.cross(middle, (0, 1, 0)) / np.linalg.norm(np.cross(middle, (0, 1, 0)))
    up = np.cross(right, middle)
    share = np.ones(len(direction))
    for way, half_degrees in ((right, box.half_width_degrees), (up, box.half_height_degrees)):
        half = np.radians(half_degrees)
        inwards = [np.sin(half) * middle + sign * np.cos(half) * way for sign in (1, -1)]  # edges' planes
        nearest = np.min([direction @ normal for normal in inwards], axis=0)
        share *= np.clip(nearest / np.sin(box.softness * half), 0, 1)
    height = direction @ up / np.sin(np.radians(box.half_height_degrees))
    return np.asarray((3 * share**2 - 2 * share**3) * (1 - box.fade * (1 - height) / 2))


def sky(scene: Scene, direction: Array) -> Array:
    """(N, 3) radiance from infinity; direction (N, 3) of unit length."""
    total = ground(scene.environment, direction)
    if scene.environment.kind in ("dark", "light"):
        return total
    for lamp in scene.emitters:
        if isinstance(lamp, PointLight):
            continue
        total = total + lamp_share(lamp, direction)[:, None] * radiance_of(lamp)
    return total


def lamp_share(lamp: RoundLamp | BoxLamp | Sun, direction: Array) -> Array:
    """(N,) the share of a lamp's radiance that each direction sees."""
    if isinstance(lamp, BoxLamp):
        return box_share(lamp, direction)
    rim, full = np.cos(np.radians(lamp.half_angle_degrees * np.array([1, 1 - lamp.softness])))
    cosine = direction @ (np.array(lamp.direction) / np.linalg.norm(lamp.direction))
    s = np.clip((cosine - rim) / (full - rim), 0, 1)
    return np.asarray(3 * s**2 - 2 * s**3)


def radiance_of(lamp: RoundLamp | BoxLamp | Sun) -> Array:
    """(3,) at its brightest. A sun's is what gives a surface that faces it pi times its colour, by quadrature."""
    if not isinstance(lamp, Sun):
        return np.array(lamp.radiance)
    angle = np.radians(lamp.half_angle_degrees) * (np.arange(20_000) + 0.5) / 20_000
    around = np.column_stack([np.sin(angle), np.cos(angle), np.zeros_like(angle)])
    share = lamp_share(lamp.model_copy(update={"direction": (0, 1, 0)}), around)
    irradiance = (
        (share * np.cos(angle) * 2 * np.pi * np.sin(angle)).sum() * np.radians(lamp.half_angle_degrees) / 20_000
    )
    return np.array(lamp.colour) * float(np.pi / irradiance)


def ground(environment: Environment, direction: Array) -> Array:
    """(N, 3) the sky without its lamps."""
    height = (0.5 * (1 + direction[:, 1]))[:, None]
    match environment:
        case ConstantEnvironment(radiance=colour):
            return np.tile(colour, (len(direction), 1))
        case LightEnvironment():
            return np.tile((0.7, 0.85, 1), (len(direction), 1))
        case HalfEnvironment(radiance=colour):
            return np.where(direction[:, 1:2] > 0, colour, 0.0)
        case GradientEnvironment(bottom=bottom, top=top):
            return np.array(bottom) * (1 - height) + np.array(top) * height
        case StudioEnvironment(ambient=ambient):
            return np.tile(np.array(ambient), (len(direction), 1))
        case _:
            return np.array((0.05, 0.05, 0.1)) * (1 - height) + np.array((0.2, 0.2, 0.3)) * height


NOTHING = np.array([[1.0, 0, 0, -1e9], [-1.0, 0, 0, -1e9]])
"""Half-spaces that no point is inside both of."""


def world_half_spaces(scene: Scene, stone: Shape | None, number: int = 0) -> Array:
    """(F, 4) the facets of the scene's stone of that number, where and as large as the scene has it."""
    if stone is None or not scene.stones:
        return NOTHING
    settings = scene.stones[number]
    w, *v = settings.orientation
    axis = np.array(v)
    normals = stone.planes[:, :3]
    turned = normals + 2 * w * np.cross(axis, normals) + 2 * np.cross(axis, np.cross(axis, normals))
    offsets = settings.scale * stone.planes[:, 3]
    return np.column_stack([turned, offsets + turned @ np.array(settings.position)])


def span(planes: Array, origin: Array, direction: Array) -> tuple[Array, Array]:
    """(N,) where the lines origin + t direction come inside all half-spaces, and where they leave: never, if they leave
    before they come."""
    gap = planes[:, 3] - origin @ planes[:, :3].T
    speed = direction @ planes[:, :3].T
    with np.errstate(divide="ignore", invalid="ignore"):
        t = gap / speed
    enter = np.where(speed < 0, t, -math.inf).max(axis=1)
    leave = np.where(speed > 0, t, math.inf).min(axis=1)
    outside = ((speed == 0) & (gap < 0)).any(axis=1)
    return np.where(outside, math.inf, enter), leave


def passes_through(
    planes: Array, origin: Array, direction: Array, length: float | Array = math.inf
) -> NDArray[np.bool_]:
    """Whether the segments origin + t direction, 0 < t < length, have a part inside all half-spaces."""
    enter, leave = span(planes, origin, direction)
    hits: NDArray[np.bool_] = np.maximum(enter, 0) < np.minimum(leave, length)
    return hits


def lighting(scene: Scene, stones: Sequence[Array], point: Array, normal: Array, which: NDArray[np.integer]) -> Array:
    """(N, 3) light on surfaces, as the radiance of white ones: the sky's, which `test_unshaded_light.py` judges, and
    each point's colour by its cosine, none of it in the shadow of any stone."""
    total = np.array(sky_light(Stage(scene, (), None))[which])
    for light in scene.points:
        way = np.array(light.position) - point
        cosine = (way * normal).sum(axis=1) / np.linalg.norm(way, axis=1)
        shaded = np.any([passes_through(planes, point, way, 1.0) for planes in stones], axis=0)
        shadow = np.where(shaded, 0.0, 1.0)
        total += (np.maximum(cosine, 0) * shadow)[:, None] * np.array(light.colour)
    return total


def cell_of(surface: Floor) -> float:
    """R."""
    if not isinstance(surface, Plane) or surface.kind != "matte" or surface.checker == "off":
        return 1.0
    return surface.checker.cell


def albedos_of(surface: Floor) -> tuple[Array, Array]:
    """(3,) of the even cells, and of the odd ones."""
    if not isinstance(surface, Plane) or surface.kind == "mirror":
        return np.full(3, 0.2 * MIRROR[0]), np.full(3, 0.2 * MIRROR[1])
    odd = np.array(surface.albedo)
    return (odd if surface.checker == "off" else np.array(surface.checker.albedo)), odd


Thrown = Callable[[NDArray[np.integer], Array], Array]
"""(N, 3) what shadows and caustics add to the light at points (N, 3) of surfaces (N,)."""


def look_around(scene: Scene, stone: Shape | None, width: int, height: int, thrown: Thrown | None = None) -> Seen:
    """(height, width) what the pixels' centres see of the room. All stones of the scene have that shape."""
    direction = pixel_directions(scene, width, height).reshape(-1, 3)
    origin = np.tile(np.array(scene.camera.position, float), (len(direction), 1))
    stones = [world_half_spaces(scene, stone, number) for number in range(len(scene.stones))] or [NOTHING]
    kinds = [scene.floor.kind, *[scene.walls.kind] * 3]
    radiance, weight = np.zeros(direction.shape), np.ones(len(direction))
    stopped, met_stone = np.zeros(len(direction), bool), np.zeros(len(direction), bool)
    while (weight * ~stopped).max() > 1e-12:
        nearest, which = np.full(len(direction), math.inf), np.full(len(direction), -1)
        for number, (surface, kind) in enumerate(zip(SURFACES, kinds, strict=True)):
            speed, gap = direction @ surface[:3], origin @ surface[:3] - surface[3]
            with np.errstate(divide="ignore", invalid="ignore"):
                t = -gap / speed
            nearer = (speed < 0) & (gap > -1e-9) & (t < nearest) & (kind != "none")
            nearest, which = np.where(nearer, t, nearest), np.where(nearer, number, which)
        in_the_way = np.any([passes_through(planes, origin, direction, nearest) for planes in stones], axis=0)
        met_stone |= ~stopped & in_the_way
        stopped |= met_stone
        seen = sky(scene, direction)
        met = which >= 0
        mirror = met & (np.array(kinds)[which] == "mirror")
        normal = SURFACES[which, :3]
        point = origin + np.where(met, nearest, 0)[:, None] * direction
        along = np.where(which == 0, point[:, 0], normal[:, 2] * point[:, 0] - normal[:, 0] * point[:, 2])
        across = np.where(which == 0, point[:, 2], point[:, 1])
        cell = np.array([cell_of(scene.floor), *[cell_of(scene.walls)] * 3])[which]
        odd = ((np.floor(along / cell) + np.floor(across / cell)) % 2).astype(int)
        albedos = np.array([albedos_of(scene.floor), *[albedos_of(scene.walls)] * 3])
        light = lighting(scene, stones, point, normal, which)
        if thrown is not None:
            added = np.where(mirror[:, None], 0, thrown(which, point))
            light = np.maximum(light + added, 0)
        seen = np.where(met[:, None], albedos[which, odd] * light, seen)
        radiance += np.where(stopped, 0, weight)[:, None] * seen
        stopped |= ~mirror
        weight = weight * 0.8
        origin = np.where(mirror[:, None], point, origin)
        direction = np.where(mirror[:, None], direction - 2 * (direction * normal).sum(1)[:, None] * normal, direction)
    return Seen(radiance.reshape(height, width, 3), met_stone.reshape(height, width))
