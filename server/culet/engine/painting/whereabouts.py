"""On which side of the picture the stones are when the camera sees none: what an empty picture does not say."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from culet.engine.session.viewpoint import axes, half_height
from culet.remembered import remembered
from culet.scene import Camera, Vector
from culet_protocol.frame import Flags

BESIDE = ((Flags.RIGHT, Flags.LEFT), (Flags.ABOVE, Flags.BELOW))
"""Beyond the picture's edges: the side of a positive distance from the middle and of a negative one, across and up."""


class Ball(NamedTuple):
    """The ball about a stone, in R."""

    position: Vector
    radius: float = 1.0


def whereabouts(camera: Camera, stones: Sequence[Ball], aspect: float) -> Flags:
    """The sides of the picture (width by height) beyond which the nearest stone is; none if a stone may be seen.

    As Cohen and Sutherland's outcodes, with the ball about a stone for a point: where only the ball reaches into the
    picture the stone counts as seen. Behind the camera there are no sides. The nearest stone is the one whose ball is
    nearest to the camera.
    """
    if not stones or _may_see_one(camera, stones, aspect):
        return Flags.NONE
    offsets = np.array([ball.position for ball in stones]) - np.array(camera.position, float)
    radii = np.array([ball.radius for ball in stones])
    along = offsets @ np.array(axes(camera)).T  # to the right, up and forward of the picture
    half = half_height(camera)
    reaches, depths = np.array((half * aspect, half)), along[:, 2]
    if camera.kind == "orthographic":
        behind = np.zeros(len(stones), bool)
        beyond = np.abs(along[:, :2]) - reaches
    else:
        behind = depths < -radii
        # To the planes through the eye and the picture's edges: (across - depth reach) / sqrt(1 + reach^2).
        beyond = (np.abs(along[:, :2]) - depths[:, None] * reaches) / np.sqrt(1 + reaches**2)
    outside = beyond > radii[:, None]
    nearest = int(np.argmin(np.linalg.norm(offsets, axis=1) - radii))
    if behind[nearest]:
        return Flags.BEHIND
    sides = Flags.NONE
    for axis in np.flatnonzero(outside[nearest]):
        sides |= BESIDE[axis][0 if along[nearest, axis] > 0 else 1]
    return sides


def _may_see_one(camera: Camera, stones: Sequence[Ball], aspect: float) -> bool:
    """Whether the ball of a stone reaches into the picture: mostly that of the first does, and each frame asks."""
    right, up, forward, half = _view(camera)
    x0, y0, z0 = camera.position
    across, parallel = half * aspect, camera.kind == "orthographic"
    for (x, y, z), radius in stones:
        offset = (x - x0, y - y0, z - z0)
        beside, above = abs(_dot(offset, right)), abs(_dot(offset, up))
        if parallel:
            seen = beside - across <= radius and above - half <= radius
        else:
            depth = _dot(offset, forward)
            seen = (
                depth >= -radius
                and beside - depth * across <= radius * math.hypot(1, across)
                and above - depth * half <= radius * math.hypot(1, half)
            )
        if seen:
            return True
    return False


@remembered
def _view(camera: Camera) -> tuple[Vector, Vector, Vector, float]:
    """`axes` and `half_height`."""
    right, up, forward = ((float(x), float(y), float(z)) for x, y, z in axes(camera))
    return right, up, forward, half_height(camera)


def _dot(one: Vector, other: Vector) -> float:
    (a, b, c), (x, y, z) = one, other
    return a * x + b * y + c * z
