"""On which side of the picture the stone is when the camera does not see it: what an empty picture does not say."""

from __future__ import annotations

import math

import numpy as np

from culet.engine.session.viewpoint import axes, half_height
from culet.scene import Camera, Vector
from culet_protocol.frame import Flags


def whereabouts(camera: Camera, position: Vector, aspect: float) -> Flags:
    """The sides of the picture (width by height) beyond which the whole of a stone there is; none if it may be seen.

    As Cohen and Sutherland's outcodes, with the stone's circumscribed ball, whose radius is the unit of length, for a
    point: where only the ball reaches into the picture the stone counts as seen. Behind the camera there are no sides.
    """
    right, up, forward = axes(camera)
    to_stone = np.array(position, float) - np.array(camera.position, float)
    x, y, depth = (float(to_stone @ axis) for axis in (right, up, forward))
    half, parallel = half_height(camera), camera.kind == "orthographic"
    if depth < -1 and not parallel:
        return Flags.BEHIND
    sides = Flags.NONE
    edges = ((y, half, Flags.ABOVE, Flags.BELOW), (x, half * aspect, Flags.RIGHT, Flags.LEFT))
    for across, reach, side, other in edges:
        # The distance to the plane through the eye and that edge: (across - depth reach) / sqrt(1 + reach^2).
        if abs(across) > reach + 1 if parallel else abs(across) - depth * reach > math.hypot(1, reach):
            sides |= side if across > 0 else other
    return sides
