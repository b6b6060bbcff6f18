"""What is under a point of the picture."""

from __future__ import annotations

import math

import numpy as np

from culet.engine.session.viewpoint import axes, half_height
from culet.geometry.shape import Shape
from culet.scene import Camera, Vector
from culet.simulation.rotation import rotate_back
from culet.simulation.state import Quaternion, Triple


def struck_point(
    camera: Camera, shape: Shape, position: Vector, orientation: Quaternion, x: float, y: float
) -> Triple | None:
    """Where the line of sight through a point of the picture enters the stone, in the world; None if it passes by.

    x to the right and y up, from the picture's centre, in halves of its height. A stone that is not convex is taken to
    be its bounding sphere.
    """
    right, up, forward = axes(camera)
    eye = np.array(camera.position, float) - np.array(position, float)
    half = half_height(camera)
    if camera.kind == "orthographic":
        sight, eye = forward, eye + half * (x * right + y * up)
    else:
        sight = forward + half * (x * right + y * up)
        sight /= np.linalg.norm(sight)
    if not shape.convex:
        along = float(eye @ sight)
        inside = along * along - float(eye @ eye) + 1
        if inside < 0:
            return None
        distance = -along - math.sqrt(inside)
    else:
        start, way = (np.array(rotate_back(orientation, (v[0], v[1], v[2]))) for v in (eye.tolist(), sight.tolist()))
        normals, offsets = shape.planes[:, :3], shape.planes[:, 3]
        towards, room = normals @ way, offsets - normals @ start
        if (room[towards == 0] < 0).any():
            return None
        crossings = room[towards != 0] / towards[towards != 0]
        entering = towards[towards != 0] < 0
        distance = float(crossings[entering].max(initial=-math.inf))
        if distance > float(crossings[~entering].min(initial=math.inf)):
            return None
    if distance <= 0 and camera.kind == "pinhole":
        return None
    hit = eye + distance * sight + np.array(position, float)
    return (float(hit[0]), float(hit[1]), float(hit[2]))
