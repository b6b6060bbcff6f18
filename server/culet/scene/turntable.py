"""A scene as it is seen from all around."""

from __future__ import annotations

import math
from collections.abc import Iterator

from culet.scene.camera import Camera
from culet.scene.fields import Vector
from culet.scene.model import Scene


def around(scene: Scene, views: int) -> Iterator[Scene]:
    """The scene from so many sides, its own first.

    The camera goes once around the vertical through its target, counter-clockwise seen from above, as the page's
    turntable does; one that looks straight down turns the picture. Lamps and stones stay where they are.
    """
    for view in range(views):
        yield scene.model_copy(update={"camera": _turned(scene.camera, 2 * math.pi * view / views)})


def _turned(camera: Camera, angle: float) -> Camera:
    """Turned by so many radians."""
    if angle == 0:  # to the bit
        return camera
    (x, y, z), (a, _, c) = camera.position, camera.target
    across, along = _about_y((x - a, 0.0, z - c), angle), _about_y(camera.up, angle)
    return camera.model_copy(update={"position": (a + across[0], y, c + across[2]), "up": along})


def _about_y(vector: Vector, angle: float) -> Vector:
    x, y, z = vector
    cosine, sine = math.cos(angle), math.sin(angle)
    return x * cosine + z * sine, y, z * cosine - x * sine
