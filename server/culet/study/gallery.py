"""The presets as pictures: small ones for the page, and those that README and docs/gallery.md show."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from culet.geometry.load import stone_of
from culet.rendering.renderer import Picture, Renderer
from culet.scene.presets import PRESETS, Preset
from culet.scene.thumbnails import SIZE

THUMBNAIL_SAMPLES, THUMBNAIL_SCALE, THUMBNAIL_QUALITY = 16, 2, 80
"""Of each pixel of a picture that is twice as large, and WebP's."""


def picture_of(renderer: Renderer, preset: Preset, width: int, height: int, samples: int) -> Picture:
    """A preset's finished picture."""
    scene = preset.scene
    stone = stone_of(scene.stones[0], {}) if scene.stones else None
    picture = renderer.picture(scene, stone, width, height)
    picture.refine(samples)
    return picture


def make_thumbnails(renderer: Renderer, folder: Path) -> Iterator[Path]:
    """Write each preset's small picture as WebP; yields the files."""
    width, height = (THUMBNAIL_SCALE * side for side in SIZE)
    for preset in PRESETS.values():
        shown = picture_of(renderer, preset, width, height, THUMBNAIL_SAMPLES).rgb()
        file = folder / f"{preset.name}.webp"
        file.write_bytes(_webp(shown))
        yield file


def _webp(shown: NDArray[np.uint8]) -> bytes:
    data = io.BytesIO()
    small = PIL.Image.fromarray(shown).resize(SIZE, PIL.Image.Resampling.LANCZOS)
    small.save(data, "WEBP", quality=THUMBNAIL_QUALITY, method=6)
    return data.getvalue()
