"""Scenes that hold little, and pictures as plain arrays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.emitters.light_map import BoundMap
from culet.rendering.features import Features, features_of
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import Scene
from shared.stages import staged

Array = NDArray[np.float64]

BARE: dict[str, Any] = {"floor": {"kind": "none"}, "walls": {"kind": "none"}}
"""A room that holds nothing but the stone."""

UPRIGHT: dict[str, Any] = {"position": [0, 0, 0], "orientation": [1, 0, 0, 0]}
"""A stone at the origin, its axes the world's."""


def take(
    renderer: Renderer,
    scene: Scene,
    stone: Shape | None = None,
    size: tuple[int, int] = (96, 54),
    samples: int = 1,
    features: Features | None = None,
    light_map: BoundMap | None = None,
) -> DevicePicture:
    """A finished picture; the stone is the scene's own cut unless another is given. No light map is made for it."""
    stage = staged(scene, stone)
    if features is None and renderer.variant.real is np.float32:
        features = program_between_few_mirrors(features_of(stage))
    picture = renderer.picture(stage, *size, features=features, light_map=light_map, effort=None)
    picture.refine(samples)
    return picture


def program_between_few_mirrors(needed: Features) -> Features | None:
    """The stone's special program, if single precision needs it to keep the light's angles; what tests ask of others is
    asked of the general programs."""
    return needed if needed.few_mirrors else None


def radiance(picture: DevicePicture) -> Array:
    """(height, width, 3), in double precision whatever the picture was made in."""
    return picture.linear().astype(np.float64)


def without_stone(scene: Scene) -> Scene:
    return scene.model_copy(update={"stones": ()})


def pixel_directions(scene: Scene, width: int, height: int) -> Array:
    """(height, width, 3) unit directions through the pixels' centres: a pinhole, written down once more from its
    definition."""
    camera = scene.camera
    forward = np.subtract(camera.target, camera.position)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right = right / np.linalg.norm(right)
    up = np.cross(right, forward)
    half = math.tan(math.radians(camera.fov_degrees) / 2)
    x = (2 * (np.arange(width) + 0.5) - width) / height * half
    y = (height - 2 * (np.arange(height) + 0.5)) / height * half
    directions = forward + x[None, :, None] * right + y[:, None, None] * up
    unit: Array = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return unit
