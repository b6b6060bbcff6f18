"""Moving the camera and the lights: pure functions from where they are to where they go.

Lengths are in R, angles in radians. y is up for lights, the camera's own `up` for the camera.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.scene import Camera, Vector

STEEPEST = math.radians(89)
"""Elevation at which an orbit stops: at the pole the camera's up would be parallel to its line of sight."""

CLOSEST = 0.05
"""R; a dolly stops this far before the point looked at, beyond which the camera would turn round."""

LEAST_HEIGHT = 1e-3
"""R, of what a picture of parallel rays shows."""

Array = NDArray[np.float64]


def orbit(camera: Camera, yaw: float, pitch: float) -> Camera:
    """The camera turned about its target: `yaw` counter-clockwise seen from above, `pitch` towards the pole."""
    position, target, up = (np.array(v, float) for v in (camera.position, camera.target, camera.up))
    return _placed(camera, target + _turned(position - target, up / np.linalg.norm(up), yaw, pitch), target)


def translate(camera: Camera, right: float, up: float) -> Camera:
    """The camera and its target, moved in the plane of the picture."""
    position, target = np.array(camera.position, float), np.array(camera.target, float)
    right_axis, up_axis, _ = axes(camera)
    shift = right * right_axis + up * up_axis
    return _placed(camera, position + shift, target + shift)


def dolly(camera: Camera, forward: float) -> Camera:
    """The camera moved towards its target, never through it; parallel rays are brought together as much."""
    position, target = np.array(camera.position, float), np.array(camera.target, float)
    offset = position - target
    distance = float(np.linalg.norm(offset))
    wanted = max(distance - forward, min(distance, CLOSEST))
    return _placed(camera, target + offset * (wanted / distance), target, camera.height * wanted / distance)


def ball_about(balls: Sequence[tuple[Vector, float]]) -> tuple[Vector, float]:
    """Centre and radius (R) of a ball that holds balls given by theirs, at most sqrt 3 times as large as need be."""
    if len(balls) == 1:  # to the bit
        return balls[0]
    centres, radii = np.array([centre for centre, _ in balls]), np.array([[radius] for _, radius in balls])
    middle = ((centres - radii).min(axis=0) + (centres + radii).max(axis=0)) / 2
    return _vector(middle), float((np.linalg.norm(centres - middle, axis=1) + radii[:, 0]).max())


def look_at(camera: Camera, point: Vector, radius: float = 1.0) -> Camera:
    """The camera moved, not turned, to where it has a ball about this point in the middle and sees all its height.

    So there is no line of sight that it cannot have, and a stone that went far away is as large as before.
    """
    offset = np.array(camera.position, float) - np.array(camera.target, float)
    distance = float(np.linalg.norm(offset))
    # R, by which the ball touches both edges
    least = radius / math.sin(math.radians(camera.fov_degrees) / 2) if camera.kind == "pinhole" else 0.0
    target = np.array(point, float)
    return _placed(camera, target + offset * (max(distance, least) / distance), target, max(camera.height, 2 * radius))


def axes(camera: Camera) -> tuple[Array, Array, Array]:
    """Right, up and forward of the picture: orthonormal, in world axes."""
    forward = np.array(camera.target, float) - np.array(camera.position, float)
    forward /= np.linalg.norm(forward)
    up = np.array(camera.up, float)
    right = np.cross(forward, up / np.linalg.norm(up))
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward), forward


def half_height(camera: Camera) -> float:
    """Of the picture: as the tangent of an angle, or in R where rays are parallel."""
    if camera.kind == "orthographic":
        return camera.height / 2
    return math.tan(math.radians(camera.fov_degrees) / 2)


def orbit_light(position: Vector, yaw: float, pitch: float) -> Vector:
    """A light turned about the origin."""
    return _vector(_turned(np.array(position, float), np.array((0.0, 1.0, 0.0)), yaw, pitch))


def shift_light(position: Vector, camera: Camera, right: float, up: float, forward: float) -> Vector:
    """A light moved along the camera's axes."""
    along = axes(camera)
    return _vector(np.array(position, float) + right * along[0] + up * along[1] + forward * along[2])


def _turned(offset: Array, up: Array, yaw: float, pitch: float) -> Array:
    """`offset` at the same distance, its azimuth about `up` and its elevation changed."""
    distance = float(np.linalg.norm(offset))
    if distance == 0:
        return offset
    height = float(offset @ up)
    level = offset - height * up
    elevation = math.atan2(height, float(np.linalg.norm(level)))
    if np.linalg.norm(level) < 1e-9 * distance:  # at the pole every azimuth is as good: leave it in some direction
        level = np.cross(up, (1.0, 0.0, 0.0) if abs(up[0]) < 0.9 else (0.0, 1.0, 0.0))
    level /= np.linalg.norm(level)
    # An authored view may be steeper than the limit: it may stay so, but not get steeper.
    limit = max(STEEPEST, abs(elevation))
    elevation = min(max(elevation + pitch, -limit), limit)
    level = level * math.cos(yaw) + np.cross(up, level) * math.sin(yaw)
    return distance * (math.cos(elevation) * level + math.sin(elevation) * up)


def _placed(camera: Camera, position: Array, target: Array, height: float | None = None) -> Camera:
    """The camera there; pydantic's ValidationError if that is beyond the range of coordinates."""
    place: dict[str, object] = {"position": _vector(position), "target": _vector(target)}
    if camera.kind == "orthographic" and height is not None:
        place["height"] = min(max(height, LEAST_HEIGHT), 1e9)
    return Camera.model_validate({**camera.model_dump(), **place})


def _vector(array: Array) -> Vector:
    x, y, z = (float(c) for c in array)
    return x, y, z
