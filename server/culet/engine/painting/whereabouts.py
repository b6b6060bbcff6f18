"""On which side of the picture the stones are when the camera sees none: what an empty picture does not say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from culet.engine.session.viewpoint import axes, half_height
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
    if not stones:
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
    if not (behind | outside.any(axis=1)).all():
        return Flags.NONE
    nearest = int(np.argmin(np.linalg.norm(offsets, axis=1) - radii))
    if behind[nearest]:
        return Flags.BEHIND
    sides = Flags.NONE
    for axis in np.flatnonzero(outside[nearest]):
        sides |= BESIDE[axis][0 if along[nearest, axis] > 0 else 1]
    return sides
