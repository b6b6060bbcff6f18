"""Small pictures of the presets, made by `culet study gallery --thumbnails`."""

from __future__ import annotations

from importlib.resources import files

from culet.errors import NotFoundError
from culet.scene.presets import PRESETS

SIZE = 192, 144
"""Pixels."""


def thumbnail_of(name: str) -> bytes:
    """The WebP picture of a preset; NotFoundError if there is no preset of that name."""
    if name not in PRESETS:
        raise NotFoundError(f"no preset {name!r}; there are: {', '.join(PRESETS)}")
    return files(__package__).joinpath(f"{name}.webp").read_bytes()
