"""Where a picture can show what spheres hold: their pixels, and whether there are any."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.rendering.features import Features, StoneCount
from culet.rendering.projection import Projection
from culet.rendering.room.studio import shade_reach
from culet.rendering.stones.placed_stone import PlacedStone, centres_of
from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, StudioFloor

Array = NDArray[np.float64]

REACH = 1.00005
"""A stone's radius to what rays are tested against, besides ROUNDING: half the 1e-4 that kernels allow one stone."""
ROUNDING = 4e-6
"""Of a position in single precision, in parts of its distance from the frame's origin: some times 6e-8 at each step."""
MARGIN = 3
"""Pixels about the rectangle where a stone is seen: filters reach one pixel further."""
FAR = 2**30
"""A pixel beyond all pictures."""
LARGER = 1.001
"""Than a sphere is what counts as in sight of the floor: the kernels' rays are not quite those of the projection."""
MOST_TILT = 0.25
"""Of a floor's normal, to each side, in parts of its length. Up to there what it mirrors is near what a level floor
mirrors: rays turn by less than 45 degrees."""


def reach_of(scales: Array, centres: Array) -> Array:
    """(N,) R about the centres of stones, relative to the frame's origin, that rays have to come into to meet them."""
    return np.asarray(REACH * scales + ROUNDING * np.linalg.norm(centres, axis=1))


def out_of_sight(
    scene: Scene, stones: Sequence[PlacedStone], projection: Projection, features: Features, width: int, height: int
) -> bool:
    """Whether a picture of many stones is the same without them: no ray of the camera meets one, or the floor where
    one shades it or is mirrored. A stone that no such ray meets may be seen in another one, or throw a shadow that is
    seen there, so they are left out all together or not at all. Of one stone, which has a program of its own, and
    wherever mirrors or shadows may show stones: False."""
    mirrors = "mirror" in (scene.floor.kind, scene.walls.kind)
    if features.stones != StoneCount.MANY or mirrors or features.lights != 0 or features.camera_inside != 0:
        return False
    centres, scales = centres_of(stones) - projection.origin, np.array([stone.scale for stone in stones])
    themselves, floor = reach_of(scales, centres), scene.floor
    if not isinstance(floor, StudioFloor):
        return not _shown(projection, centres, themselves, width, height)
    if scene.camera.kind == "orthographic" or floor.roughness > MOST_TILT:
        return False  # parallel rays begin nowhere in particular, and so may be turned aside by any length
    images = centres * [1, -1, 1]
    images[:, 1] += 2 * (FLOOR_Y - projection.origin[1])
    # A floor that is tilted along x and along z turns a ray by at most twice the angle between the normals. Where such
    # a ray meets the floor is no farther from the stone than its image is from the eye; or, if it meets the stone
    # sideways or backwards, no farther than two of its radii.
    way = np.linalg.norm(images - (np.array(scene.camera.position) - projection.origin), axis=1) + 2 * scales
    shades, mirrored = scales * shade_reach(stones), scales + 2 * np.sqrt(2) * floor.roughness * way
    reach = np.concatenate([np.maximum(themselves, LARGER * shades), LARGER * mirrored])
    return not _shown(projection, np.concatenate([centres, images]), reach, width, height)


def _shown(projection: Projection, centres: Array, reach: Array, width: int, height: int) -> bool:
    """Whether a ray of the picture may meet one of the spheres."""
    columns, rows = footprints(projection, centres, reach, width, height)
    seen = (columns[:, 0] < width) & (columns[:, 1] >= 0) & (rows[:, 0] < height) & (rows[:, 1] >= 0)
    return bool(seen.any())


def footprints(projection: Projection, centres: Array, reach: Array, width: int, height: int) -> tuple[Array, Array]:
    """(N, 2) first and last column, and row, of the pixels whose rays may meet each of N spheres. None: the last is
    before the first.

    By column a pinhole's rays are those of a plane angle, in which the sphere is a disc.
    """
    corner, column, row = projection.direction
    forward = corner + column * (width / 2) + row * (height / 2)
    eye = projection.foot[0] - projection.reach * corner
    ranges = []
    for number, size in ((1, width), (2, height)):
        step = projection.direction[number]
        if not step.any():  # parallel rays
            pitch = float(np.linalg.norm(projection.foot[number]))
            middle = (centres - projection.foot[0]) @ projection.foot[number] / pitch**2
            ranges.append(_pixels(middle - reach / pitch, middle + reach / pitch))
            continue
        pitch = float(np.linalg.norm(step))
        x, z = (centres - eye) @ step / pitch, (centres - eye) @ forward
        distance = np.hypot(x, z)
        angle, half = np.arctan2(x, z), np.arcsin(np.minimum(reach / np.maximum(distance, 1e-300), 1))
        low, high = angle - half, angle + half
        first = np.where(low > -np.pi / 2, np.tan(low) / pitch + size / 2, -FAR)
        last = np.where(high < np.pi / 2, np.tan(high) / pitch + size / 2, FAR)
        behind = (low >= np.pi / 2) | (high <= -np.pi / 2)
        first, last = np.where(behind, FAR, first), np.where(behind, -FAR, last)
        within = distance <= reach
        ranges.append(_pixels(np.where(within, -FAR, first), np.where(within, FAR, last)))
    return ranges[0], ranges[1]


def _pixels(first: Array, last: Array) -> Array:
    return np.column_stack([np.clip(first, -FAR, FAR) - MARGIN, np.clip(last, -FAR, FAR) + MARGIN]).astype(np.int64)
