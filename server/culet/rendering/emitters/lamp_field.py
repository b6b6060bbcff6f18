"""A lamp's radiance over directions, in cells: its light on floor and walls, and directions within it.

A direction is open if no surface of the room hides it. Surfaces are endless planes, so that the same directions are
open to every place of the room: those in front of all surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from culet.rendering.room.studio import box_axes
from culet.rendering.room.surfaces import room_surfaces
from culet.scene.emitters import BoxLamp, RoundLamp

Array = NDArray[np.float64]
Lamp = RoundLamp | BoxLamp

CELLS = 128
"""Across a lamp, and around it or up. Its light by these cells is exact to 2e-4."""
CELLS_CUT = 256
"""The same where a surface of the room cuts the lamp."""
ALL = 0, 1, 2, 3
R2 = 0.7548776662466927, 0.5698402909980532
"""Steps of the R2 sequence (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018)."""


def normals(surfaces: tuple[int, ...]) -> Array:
    """(S, 3) inward, of surfaces by number: 0 the floor, 1 to 3 the walls."""
    return room_surfaces(np.zeros(3))[list(surfaces), :3]


@dataclass(frozen=True, eq=False)
class LampField:
    """The open part of a lamp. Its two parameters are 1 - cosine and azimuth of a disc, and the angles across and up of
    a box."""

    lamp: Lamp
    shown: tuple[int, ...]
    """Surfaces of the room, by number."""
    first: Array
    """(P + 1,) edges of the cells."""
    second: Array
    """(Q + 1,)"""
    weights: Array
    """(P, Q) share of the lamp's radiance times solid angle, sr; 0 in cells whose middle is hidden."""
    solid_angle: float
    """sr, of its radiance: the irradiance, over the radiance, of something that faces all of it."""
    projected: Array
    """(4,) sr: the irradiance, over the lamp's radiance, of the floor and each wall."""

    def sample(self, number: int) -> Array:
        """(3,) the open direction of that number in a sequence that is spread as the lamp's light is."""
        a, b = (0.5 + number * R2[0]) % 1, (0.5 + number * R2[1]) % 1
        row, p = _picked(self.weights.sum(axis=1), a)
        column, q = _picked(self.weights[row], b)
        for across, up in ((p, q), (0.5, 0.5)):  # a cell that a surface cuts is open in the middle
            found = _directions(self.lamp, _within(self.first, row, across), _within(self.second, column, up))
            if (normals(self.shown) @ found > 0).all():
                break
        return found


def _picked(weights: Array, part: float) -> tuple[int, float]:
    """The cell that a part of all weight leads to, and the part of the way through it."""
    sums = np.cumsum(weights)
    wanted = part * sums[-1]
    cell = int(min(np.searchsorted(sums, wanted, side="right"), np.flatnonzero(weights)[-1]))
    return cell, float(np.clip((wanted - (sums[cell] - weights[cell])) / weights[cell], 0, 1))


def _within(edges: Array, cell: int, part: float) -> Array:
    return np.array(edges[cell] + part * (edges[cell + 1] - edges[cell]))


@lru_cache(maxsize=64)
def lamp_field(lamp: Lamp, shown: tuple[int, ...]) -> LampField:
    """The field of a lamp in a room of those surfaces."""
    cells = CELLS_CUT if _cut(lamp, shown) else CELLS
    first, second = _edges(lamp, cells)
    p, q = (edges[:-1] + np.diff(edges) / 2 for edges in (first, second))
    directions = _directions(lamp, p[:, None], q[None, :])
    weights = _density(lamp, p[:, None], q[None, :], directions) * np.diff(first)[:, None] * np.diff(second)[None, :]
    cosines = directions @ normals(ALL).T
    light = weights * _open_parts(cosines[..., list(shown)])
    projected = np.einsum("pq,pqs->s", light, np.maximum(cosines, 0))
    if isinstance(lamp, RoundLamp) and wholly_open(lamp, shown):
        projected[list(shown)] = facing(lamp) * (normals(shown) @ _unit(lamp.direction))
    weights = weights * (cosines[..., list(shown)] > 0).all(axis=-1)
    return LampField(lamp, shown, first, second, weights, float(light.sum()), projected)


def _open_parts(cosines: Array) -> Array:
    """(P, Q) the part of each cell that is before all surfaces, from the cosines (P, Q, S) of cells' middles to them:
    where a surface's plane cuts a cell, by how far the cell reaches to both its sides."""
    reach = sum(abs(np.gradient(cosines, axis=axis)) for axis in (0, 1))
    return np.asarray(np.clip(0.5 + cosines / np.maximum(reach, 1e-12), 0, 1).prod(axis=-1))


def widest_degrees(lamp: Lamp) -> float:
    """From a lamp's middle to its farthest edge."""
    if isinstance(lamp, RoundLamp):
        return lamp.half_angle_degrees
    across, up = np.tan(np.radians([lamp.half_width_degrees, lamp.half_height_degrees]))
    return float(np.degrees(np.arctan(np.hypot(across, up))))


def wholly_open(lamp: Lamp, shown: tuple[int, ...]) -> bool:
    """Whether no surface hides a part of it."""
    rises = np.degrees(np.arcsin(np.clip(normals(shown) @ _unit(lamp.direction), -1, 1)))
    return bool((rises >= widest_degrees(lamp)).all())


def _cut(lamp: Lamp, shown: tuple[int, ...]) -> bool:
    rises = np.degrees(np.arcsin(np.clip(normals(shown) @ _unit(lamp.direction), -1, 1)))
    return bool((abs(rises) < widest_degrees(lamp)).any() and (rises > -widest_degrees(lamp)).all())


def rims(lamp: RoundLamp) -> tuple[float, float]:
    """1 - cosine up to where a disc has its full radiance, and from where it has none; smoothstep between."""
    full, rim = 2 * np.sin(np.radians(lamp.half_angle_degrees * np.array([1 - lamp.softness, 1])) / 2) ** 2
    return float(full), float(rim)


def facing(lamp: RoundLamp) -> float:
    """sr: the irradiance, over a disc's radiance, of a surface that faces it: the integral of its smoothstep over
    x = 1 - cosine, times the cosine. A disc wholly before a surface gives it as much, times its middle's cosine."""
    full, rim = rims(lamp)
    width = rim - full
    return 2 * np.pi * (full - full * full / 2 + width * ((1 - rim) / 2 + 7 * width / 20))


def _edges(lamp: Lamp, cells: int) -> tuple[Array, Array]:
    if isinstance(lamp, RoundLamp):
        full, rim = rims(lamp)
        x = np.concatenate([np.linspace(0, full, cells // 2 + 1)[:-1], np.linspace(full, rim, cells // 2 + 1)])
        return np.unique(x), np.linspace(0, 2 * np.pi, cells + 1)
    across, up = np.radians([lamp.half_width_degrees, lamp.half_height_degrees])
    return np.linspace(-across, across, cells + 1), np.linspace(-up, up, cells + 1)


def _directions(lamp: Lamp, p: Array, q: Array) -> Array:
    """(..., 3) of unit length."""
    if isinstance(lamp, RoundLamp):
        middle = _unit(lamp.direction)
        first = np.cross(middle, (0, 1, 0) if abs(middle[1]) < 0.9 else (1, 0, 0))
        first = first / np.linalg.norm(first)
        second, sine = np.cross(first, middle), np.sqrt(p * (2 - p))
        parts = ((1 - p, middle), (sine * np.cos(q), first), (sine * np.sin(q), second))
        return np.asarray(sum(part[..., None] * axis for part, axis in parts))
    to_box, right, up = box_axes(lamp)
    ways = to_box + np.tan(p)[..., None] * right + np.tan(q)[..., None] * up
    return np.asarray(ways / np.linalg.norm(ways, axis=-1, keepdims=True))


def _density(lamp: Lamp, p: Array, q: Array, directions: Array) -> Array:
    """Share of the lamp's radiance times solid angle, by its parameters."""
    if isinstance(lamp, RoundLamp):
        full, rim = rims(lamp)
        s = np.clip((rim - p) / (rim - full), 0, 1)
        return np.asarray(s * s * (3 - 2 * s) + 0 * q)
    to_box, right, up = box_axes(lamp)
    way, rise = directions @ to_box, directions @ up
    share = np.ones(way.shape)
    for half, along in ((lamp.half_width_degrees, directions @ right), (lamp.half_height_degrees, rise)):
        angle = np.radians(half)
        share = share * np.clip(
            (np.sin(angle) * way - np.cos(angle) * abs(along)) / np.sin(lamp.softness * angle), 0, 1
        )
    level = 1 - lamp.fade / 2 * (1 - rise / np.sin(np.radians(lamp.half_height_degrees)))
    # tan p and tan q are where a plane at distance 1 is met: dA = dp dq / (cos p cos q)^2, times the cosine cubed
    return np.asarray(share * share * (3 - 2 * share) * level * way**3 / (np.cos(p) * np.cos(q)) ** 2)


def _unit(vector: object) -> Array:
    direction = np.asarray(vector, dtype=float)
    return np.asarray(direction / np.linalg.norm(direction))
