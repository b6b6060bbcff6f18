"""The report's estimator once more, from its listings (sections 5 to 7), pixel by pixel in double precision.

Like the report's shader it meets triangles by Moller and Trumbore, one path for each channel, and steps off surfaces
by an epsilon; nothing here is shared with the kernels but the description.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.optics.dispersion import channel_indices
from culet.scene import Scene
from rendering.room_reference import SURFACES, sky
from rendering.views import Array, pixel_directions

EPSILON = 1e-9
"""R that a ray is moved off a surface; the report's 1e-3 suits single precision."""


def classic_picture(scene: Scene, stone: Shape, width: int, height: int) -> Array:
    """(height, width, 3) linear radiance."""
    directions = pixel_directions(scene, width, height).reshape(-1, 3)
    channels = [_paths(scene, stone, directions, channel) for channel in range(3)]
    return np.stack(channels, axis=-1).reshape(height, width, 3)


def _paths(scene: Scene, stone: Shape, direction: Array, channel: int) -> Array:
    settings = scene.stones[0]
    eta = channel_indices(settings.material)[channel]
    corners = stone.vertices @ _rotation(settings.orientation).T + np.array(settings.position)
    triangles = corners[stone.triangles]
    kinds = [scene.floor.kind, *[scene.walls.kind] * 3]
    origin = np.tile(np.array(scene.camera.position, float), (len(direction), 1))
    weight, radiance = np.ones(len(direction)), np.zeros(len(direction))
    alive = np.arange(len(direction))
    for meeting in range(scene.optics.max_bounces):
        o, d = origin[alive], direction[alive]
        t, normal, surface = _nearest(o, d, triangles, kinds)
        missed = ~np.isfinite(t)
        radiance[alive[missed]] += weight[alive[missed]] * sky(scene, d[missed])[:, channel]
        alive, o, d = alive[~missed], o[~missed], d[~missed]
        t, normal, surface = t[~missed], normal[~missed], surface[~missed]
        if len(alive) == 0:
            break
        reflected = d - 2 * (d * normal).sum(1)[:, None] * normal
        if meeting == scene.optics.max_bounces - 1:
            radiance[alive] += weight[alive] * sky(scene, reflected)[:, channel]
            break
        point = o + t[:, None] * d
        goes_on = np.ones(len(alive), bool)
        next_origin, next_direction = point + EPSILON * normal, reflected.copy()

        room = surface >= 0
        shown, mirror = _room(scene, point[room], normal[room], surface[room], triangles, channel, kinds)
        radiance[alive[room]] += weight[alive[room]] * shown
        weight[alive[room]] *= np.where(mirror, 0.8, 1)
        goes_on[room] = mirror

        gem = ~room
        outward = normal[gem]
        entering = surface[gem] == FRONT
        cosine = -(d[gem] * outward).sum(1)
        f0 = ((1 - eta) / (1 + eta)) ** 2
        term = f0 + (1 - f0) * (1 - cosine) ** 5
        radiance[alive[gem]] += weight[alive[gem]] * term * sky(scene, reflected[gem])[:, channel]
        ratio = np.where(entering, 1 / eta, eta)
        squared = 1 - ratio**2 * (1 - cosine**2)
        through = squared >= 0
        bent = ratio[:, None] * d[gem] + (ratio * cosine - np.sqrt(np.maximum(squared, 0)))[:, None] * outward
        left = settings.absorption[channel] * t[gem] * ~entering
        weight[alive[gem]] *= np.where(through, (1 - term) * np.exp(-left), 1)
        next_direction[gem] = np.where(through[:, None], bent, reflected[gem])
        next_origin[gem] = point[gem] + np.where(through, -EPSILON, EPSILON)[:, None] * outward

        origin[alive], direction = next_origin, direction.copy()
        direction[alive] = next_direction
        alive = alive[goes_on]
    return radiance


FRONT, BACK = -1, -2
"""Instead of a room's surface: the stone from outside, from inside."""


def _nearest(o: Array, d: Array, triangles: Array, kinds: Sequence[str]) -> tuple[Array, Array, NDArray[np.int64]]:
    """Distance (infinite for none), normal towards the ray, and what was met."""
    t, normal, surface = np.full(len(o), np.inf), np.zeros((len(o), 3)), np.zeros(len(o), np.int64)
    for number, (plane, kind) in enumerate(zip(SURFACES, kinds, strict=True)):
        if kind == "none":
            continue
        speed = d @ plane[:3]
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (plane[3] - o @ plane[:3]) / speed
        nearer = (speed < 0) & (distance > EPSILON) & (distance < t)
        t[nearer], normal[nearer], surface[nearer] = distance[nearer], plane[:3], number
    for a, b, c in triangles:
        first, second = b - a, c - a
        outward = np.cross(first, second)
        p = np.cross(d, second)
        det = p @ first
        with np.errstate(divide="ignore", invalid="ignore"):
            s = o - a
            u = (s * p).sum(1) / det
            q = np.cross(s, first)
            v = (d * q).sum(1) / det
            distance = q @ second / det
        nearer = (np.abs(det) > 1e-14) & (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > EPSILON) & (distance < t)
        back = (d @ outward > 0)[nearer]
        t[nearer] = distance[nearer]
        normal[nearer] = np.where(back, -1, 1)[:, None] * outward / np.linalg.norm(outward)
        surface[nearer] = np.where(back, BACK, FRONT)
    return t, normal, surface


def _room(
    scene: Scene,
    point: Array,
    normal: Array,
    surface: NDArray[np.int64],
    triangles: Array,
    channel: int,
    kinds: Sequence[str],
) -> tuple[Array, NDArray[np.bool_]]:
    """What floor and walls show of themselves, and which of them are mirrors."""
    if len(point) == 0:
        return np.zeros(0), np.zeros(0, bool)
    x, y, z = point.T
    on_floor = surface == 0
    u, v = np.where(on_floor, x, normal[:, 2] * x - normal[:, 0] * z), np.where(on_floor, z, y)
    odd = (np.floor(u) + np.floor(v)) % 2 > 0.5
    light = np.full(len(point), 0.2)
    for lamp in scene.points:
        to_light = np.array(lamp.position) - point
        distance = np.linalg.norm(to_light, axis=1)
        to_light /= distance[:, None]
        t, _, met = _nearest(point + EPSILON * normal, to_light, triangles, ["none"] * 4)
        shadow = np.where((t < distance) & (met < 0), 0.2, 1)
        light += lamp.colour[channel] * np.maximum((normal * to_light).sum(1), 0) * shadow
    mirror = np.array([kind == "mirror" for kind in kinds])[surface]
    albedo = np.where(mirror, np.where(odd, 0.05, 0.1), np.where(odd, 0.9, 0.6))
    return albedo * light * np.where(mirror, 0.2, 1), mirror


def _rotation(quaternion: tuple[float, float, float, float]) -> Array:
    w, axis = quaternion[0], np.array(quaternion[1:])
    angle = 2 * math.atan2(float(np.linalg.norm(axis)), w)
    if not axis.any():
        return np.eye(3)
    k = axis / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    rotation: Array = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return rotation
