"""Stages of shapes and panoramas that no scene names: what `Stage.of` makes with a library of uploads."""

from __future__ import annotations

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.optics.panoramas import Panorama
from culet.scene import Scene
from culet.stage import NOTHING, Stage


def staged(scene: Scene, shape: Shape | None = None, panorama: Panorama | None = None) -> Stage:
    """The scene with its stones of this shape and under this panorama, in place of what the scene names."""
    shapes = tuple(shape or shape_of(stone, {}) for stone in scene.stones)
    return Stage(scene, shapes, NOTHING.sky(scene.environment).panorama if panorama is None else panorama)
