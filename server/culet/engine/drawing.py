"""What the engine needs of a renderer; `culet.rendering.renderer.Renderer` is one.

Everything here is called from one thread only, the render thread.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from culet.geometry.stone import Stone
from culet.rendering.panoramas import Panorama
from culet.scene import Scene

BAND_PIXELS = 2**17
"""Pixels that get one more sample before other work gets its turn: some 10 ms of the default scene on two cores."""
BAND_ROWS = 32
"""Rows of the thinnest band: a row of the renderer's tiles."""


class Picture(Protocol):
    """An image that gets better with every sample."""

    @property
    def scene(self) -> Scene:
        """What it shows."""

    @property
    def samples(self) -> int:
        """Samples per pixel so far."""

    @property
    def seconds(self) -> float:
        """Render seconds of the last refinement."""

    def refine(self, samples: int = 1) -> None:
        """Add samples to every pixel."""

    def refine_in_bands(self, samples: int, rows: int) -> Iterator[Any]:
        """Add samples to every pixel, some rows at a time for each sample, yielding between them."""

    def rgb(self) -> NDArray[np.uint8]:
        """(height, width, 3), tone-mapped."""

    def cut(self) -> float:
        """Mean weight of what the cut-off dropped."""

    def error_estimate(self) -> float:
        """Root mean square error of the radiance; NaN below two samples."""


class Renderer(Protocol):
    """A device that draws scenes."""

    def picture(
        self, scene: Scene, stone: Stone | None, width: int, height: int, *, panorama: Panorama | None = None
    ) -> Picture:
        """An empty picture of the scene, its stone where the scene has it; `panorama` is that of its sky."""

    def forget(self, panorama: Panorama) -> None:
        """A sky that no scene shows any more. From any thread."""

    def held(self) -> Mapping[str, int]:
        """Bytes of memory, by what takes them. From any thread."""

    def release(self) -> None:
        """Give back the memory of pictures that are gone."""

    def describe(self) -> Mapping[str, Any]:
        """Device, driver and lanes."""


def band_rows(width: int) -> int:
    """Rows of a band of BAND_PIXELS."""
    return max(BAND_ROWS, BAND_PIXELS // width)
