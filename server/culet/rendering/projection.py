"""The camera and the stone's place, in double precision: where each pixel's ray passes the stone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.scene.model import Scene

Array = NDArray[np.float64]


def rotation_matrix(orientation: tuple[float, float, float, float]) -> Array:
    """(3, 3), the stone's axes in the world as columns, from a unit quaternion w, x, y, z."""
    w, x, y, z = orientation
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def placement(scene: Scene) -> tuple[Array, Array]:
    """The stone's centre (3,) and rotation (3, 3); the world's origin where there is no stone."""
    stone = scene.only_stone()
    if stone is None:
        return np.zeros(3), np.eye(3)
    return np.array(stone.position), rotation_matrix(stone.orientation)


def world_planes(scene: Scene, shape: Shape) -> Array:
    """(F, 4) facets in the world's axes, relative to the stone's centre."""
    _, rotation = placement(scene)
    return np.column_stack([shape.planes[:, :3] @ rotation.T, shape.planes[:, 3]])


def camera_is_inside(scene: Scene, shape: Shape) -> bool:
    """Whether the eye is within the stone's surface; on it counts as outside. Parallel rays begin outside."""
    if scene.camera.kind == "orthographic":
        return False
    centre, rotation = placement(scene)
    eye = (np.array(scene.camera.position) - centre) @ rotation
    if eye @ eye >= 1:
        return False
    if shape.convex:
        return bool((shape.planes[:, :3] @ eye < shape.planes[:, 3]).all())
    return abs(_winding_number(shape, eye)) > 0.5


def _winding_number(shape: Shape, point: Array) -> float:
    """How often the surface encloses a point: the sum of the triangles' solid angles over 4 pi (Van Oosterom &
    Strackee, IEEE Trans. Biomed. Eng. 30, 125 (1983), eq. 8)."""
    a, b, c = (shape.vertices[shape.triangles[:, k]] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(2 * np.arctan2(triple, dots).sum() / (4 * np.pi))


NEAREST_PLANE = 2.0
"""R from the stone's centre, within which no parallel rays begin: the whole stone is in front of them."""


@dataclass(frozen=True, eq=False)
class Projection:
    """Rays of a camera as affine functions of the pixel: foot + x column + y row, x and y in pixels."""

    foot: Array
    """(3, 3): the point of pixel (0, 0)'s ray abreast of the stone, relative to it; its change by column; by row."""
    direction: Array
    """(3, 3): the direction, not of unit length; its change by column; by row."""
    reach: float
    """From the eye to the foot, in lengths of the direction."""


def project(scene: Scene, width: int, height: int) -> Projection:
    """The rays of a picture of that size. A foot is never behind the eye: there the eye itself takes its place."""
    camera = scene.camera
    centre, _ = placement(scene)
    eye = np.array(camera.position, dtype=float) - centre
    forward = np.array(camera.target, dtype=float) - np.array(camera.position, dtype=float)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, np.array(camera.up, dtype=float))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    if camera.kind == "orthographic":
        column, row = right * (camera.height / height), -up * (camera.height / height)
        along = float(-eye @ forward)
        corner = eye + along * forward - column * (width / 2) - row * (height / 2)
        return Projection(
            foot=np.array([corner, column, row]),
            direction=np.array([forward, np.zeros(3), np.zeros(3)]),
            reach=max(along, NEAREST_PLANE),
        )
    half_height = np.tan(np.radians(camera.fov_degrees) / 2)
    column, row = right * (2 * half_height / height), -up * (2 * half_height / height)
    corner = forward - column * (width / 2) - row * (height / 2)
    reach = max(0.0, float(-eye @ forward))
    return Projection(
        foot=np.array([eye + reach * corner, reach * column, reach * row]),
        direction=np.array([corner, column, row]),
        reach=reach,
    )
