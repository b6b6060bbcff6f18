"""The part of the sky that the room leaves open, and what a surface of the room sees in place of the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.rendering.emitters.lamp_field import ALL, normals
from culet.rendering.room.sky_colours import sky_colours
from culet.rendering.room.surfaces import room_surfaces
from culet.scene.sky import Environment, HalfEnvironment

Array = NDArray[np.float64]

ROWS, COLUMNS = 512, 720
"""Of the sphere, in equal steps of height and of azimuth: the edges of the open sky run between cells."""
STANDPOINT = 2.0
"""R above the floor from where a wall sees the others."""


@dataclass(frozen=True, eq=False)
class OpenSky:
    """What floor and walls see. All but `others` are over pi: the radiosity of a white surface."""

    even: Array
    """(4,) under a radiance of 1,"""
    rising: Array
    """(4,) under one that is the direction's y,"""
    upper: Array
    """(4,) and under one of 1 above the horizon, 0 below."""
    others: Array
    """(4, 4) the share of each surface's view that each other one takes, as seen from the foot of the world's origin on
    each of them: walls and floor are endless, so that their shares of the whole hardly depend on the place."""


_KNOWN: dict[tuple[int, ...], OpenSky] = {}
"""By surfaces, of which there are four."""


def is_known(shown: tuple[int, ...]) -> bool:
    """Whether `open_sky` takes no time."""
    return not shown or shown in _KNOWN


def open_sky(shown: tuple[int, ...]) -> OpenSky:
    """Of a room of those surfaces; found once, which takes 0.3 s."""
    if shown not in _KNOWN:
        _KNOWN[shown] = _found(shown)
    return _KNOWN[shown]


def _found(shown: tuple[int, ...]) -> OpenSky:
    height = (np.arange(ROWS) + 0.5) * 2 / ROWS - 1
    azimuth = (np.arange(COLUMNS) + 0.5) * 2 * np.pi / COLUMNS
    level = np.sqrt(1 - height**2)[:, None]
    directions = np.stack(
        [level * np.sin(azimuth), np.broadcast_to(height[:, None], (ROWS, COLUMNS)), level * np.cos(azimuth)], axis=-1
    ).reshape(-1, 3)
    solid_angle = 4 * np.pi / len(directions)
    open_ = np.all(directions @ normals(shown).T > 0, axis=-1)
    cosines = np.maximum(directions @ normals(ALL).T, 0) * (solid_angle / np.pi)
    rise = directions[:, 1]
    seen = (cosines * open_[:, None]).T
    return OpenSky(seen.sum(1), seen @ rise, seen @ (rise > 0), _others(shown, directions, cosines))


def _others(shown: tuple[int, ...], directions: Array, cosines: Array) -> Array:
    planes, shares = room_surfaces(np.zeros(3)), np.zeros((4, 4))
    for number in shown:
        place = planes[number, :3] * planes[number, 3] + (number > 0) * np.array([0, planes[0, 3] + STANDPOINT, 0])
        targets = [other for other in shown if other != number]
        if not targets:
            continue
        speeds = directions @ planes[targets, :3].T
        gaps = planes[targets, :3] @ place - planes[targets, 3]
        with np.errstate(divide="ignore"):
            distances = np.where(speeds < 0, gaps / -speeds, np.inf)
        met = np.where(np.isfinite(distances.min(axis=1)), np.argmin(distances, axis=1), -1)
        for index, other in enumerate(targets):
            shares[number, other] = cosines[met == index, number].sum()
    return shares


def ground_light(environment: Environment, sky: OpenSky) -> Array:
    """(4, 3) the light of a sky that needs no picture, without its lamps."""
    bottom, top = (np.array(colour) for colour in sky_colours(environment))
    if isinstance(environment, HalfEnvironment):
        return np.outer(sky.upper, top)
    return np.outer(sky.even, (bottom + top) / 2) + np.outer(sky.rising, (top - bottom) / 2)
