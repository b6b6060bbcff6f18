"""Scenes and stones whose pictures have closed forms, and pictures as plain arrays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.geometry.half_spaces import stone_from_half_spaces
from culet.geometry.load import stone_of
from culet.geometry.stone import Stone
from culet.rendering.features import Features
from culet.rendering.renderer import Picture, Renderer
from culet.scene import Scene

Array = NDArray[np.float64]

BARE: dict[str, Any] = {"floor": {"kind": "none"}, "walls": {"kind": "none"}, "lights": []}
"""A room that holds nothing but the stone."""

UPRIGHT: dict[str, Any] = {"position": [0, 0, 0], "orientation": [1, 0, 0, 0]}
"""A stone at the origin, its axes the world's."""


def take(
    renderer: Renderer,
    scene: Scene,
    stone: Stone | None = None,
    size: tuple[int, int] = (96, 54),
    samples: int = 1,
    features: Features | None = None,
) -> Picture:
    """A finished picture; the stone is the scene's own cut unless another is given."""
    if stone is None and scene.stones:
        stone = stone_of(scene.stones[0], {})
    picture = renderer.picture(scene, stone, *size, features=features)
    picture.refine(samples)
    return picture


def radiance(picture: Picture) -> Array:
    """(height, width, 3), in double precision whatever the picture was made in."""
    return picture.linear().astype(np.float64)


def without_stone(scene: Scene) -> Scene:
    return scene.model_copy(update={"stones": ()})


def slab(half_height: float) -> Stone:
    """A plate between y = -half_height and half_height, of square outline; its corners are at distance 1."""
    half_width = math.sqrt((1 - half_height**2) / 2)
    planes = [
        [*(sign * np.eye(3)[axis]), extent]
        for axis, extent in enumerate((half_width, half_height, half_width))
        for sign in (1, -1)
    ]
    return stone_from_half_spaces("slab", np.array(planes))


def prism(apex_degrees: float) -> Stone:
    """A prism along z with its apex up: facet 0 faces -x, facet 1 faces +x, both half the apex angle from vertical."""
    half = math.radians(apex_degrees) / 2
    left, right = [-math.cos(half), math.sin(half), 0, 0], [math.cos(half), math.sin(half), 0, 0]
    return stone_from_half_spaces("prism", np.array([left, right, [0, -1, 0, 1], [0, 0, 1, 1], [0, 0, -1, 1.0]]))


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
