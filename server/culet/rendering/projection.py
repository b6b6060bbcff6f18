"""The camera, in double precision: where each pixel's ray passes the stones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.rendering.stones.placed_stone import PlacedStone, extent_of, origin_of
from culet.scene.model import Scene

Array = NDArray[np.float64]


NEAREST_PLANE = 1.0
"""R from the outermost point of a stone, seen from their middle, within which no parallel rays begin: all stones are in
front of them."""


@dataclass(frozen=True, eq=False)
class Projection:
    """Rays of a camera as affine functions of the pixel: foot + x column + y row, x and y in pixels."""

    origin: Array
    """(3,) in the world: what positions are relative to, see `origin_of`."""
    foot: Array
    """(3, 3): the point of pixel (0, 0)'s ray abreast of the stones' middle, relative to that; its change by column; by
    row."""
    direction: Array
    """(3, 3): the direction, not of unit length; its change by column; by row."""
    reach: float
    """From the eye to the foot, in lengths of the direction."""


def project(scene: Scene, stones: Sequence[PlacedStone], width: int, height: int) -> Projection:
    """The rays of a picture of that size. A foot is never behind the eye: there the eye itself takes its place."""
    camera = scene.camera
    origin = origin_of(scene, stones)
    eye = np.array(camera.position, dtype=float) - origin
    forward = np.array(camera.target, dtype=float) - np.array(camera.position, dtype=float)
    forward /= np.linalg.norm(forward)
    right = _cross(forward, np.array(camera.up, dtype=float))
    right /= np.linalg.norm(right)
    up = _cross(right, forward)
    if camera.kind == "orthographic":
        column, row = right * (camera.height / height), -up * (camera.height / height)
        along = float(-eye @ forward)
        corner = eye + along * forward - column * (width / 2) - row * (height / 2)
        return Projection(
            origin=origin,
            foot=np.array([corner, column, row]),
            direction=np.array([forward, np.zeros(3), np.zeros(3)]),
            reach=max(along, extent_of(stones, origin) + NEAREST_PLANE),
        )
    half_height = np.tan(np.radians(camera.fov_degrees) / 2)
    column, row = right * (2 * half_height / height), -up * (2 * half_height / height)
    corner = forward - column * (width / 2) - row * (height / 2)
    reach = max(0.0, float(-eye @ forward))
    return Projection(
        origin=origin,
        foot=np.array([eye + reach * corner, reach * column, reach * row]),
        direction=np.array([corner, column, row]),
        reach=reach,
    )


def _cross(a: Array, b: Array) -> Array:
    """`np.cross` takes ten times as long for two vectors, and each frame asks."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
