"""What a study is of, and the picture of it."""

from __future__ import annotations

from typing import NamedTuple

from culet.geometry.shape import Shape
from culet.rendering.panoramas import Panorama
from culet.scene import Scene


class Studied(NamedTuple):
    """What a study is of."""

    scene: Scene
    stone: Shape
    panorama: Panorama | None = None
    """The sky from a file."""


class Frame(NamedTuple):
    """A picture of it."""

    subject: Studied
    width: int
    height: int
