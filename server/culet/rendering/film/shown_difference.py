"""How far two runs of samples are apart on a screen."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pyopencl as cl

from culet.rendering.chains import is_spectral
from culet.rendering.opencl.device import Device
from culet.scene.model import Scene

BLOCK = 1024
"""Pixels of a work-item."""
PIECE = 2**19
"""Pixels that are compared at a time: some 10 ms."""

TONE_MAPS = {"none": 0, "srgb": 1, "classic": 2, "filmic": 3, "neutral": 4}
"""As film.cl numbers them."""


def film_arguments(scene: Scene, samples: int) -> tuple[np.generic, ...]:
    """What film.cl's kernels are told last, to show the mean of so many samples."""
    film = scene.film
    inside_gamut = film.gamut == "clip" or not is_spectral(scene)
    return np.float32(film.exposure / max(1, samples)), np.int32(TONE_MAPS[film.tone_map]), np.int32(inside_gamut)


class ShownDifference:
    """The kernel that compares."""

    def __init__(self, device: Device, program: Any) -> None:  # noqa: ANN401 - pyopencl has no types
        """`program` is film.cl's."""
        self._device = device
        self._kernel = cl.Kernel(program, "apart_as_shown")

    def warm_up(self, scratch: Any) -> None:  # noqa: ANN401
        """Launch once for no pixels."""
        none = np.int32(0)
        self._kernel(
            self._device.queue, (1,), (1,), scratch, scratch, scratch, np.int32(BLOCK), none, none, np.float32(0), none,
            none,
        )  # fmt: skip

    def pieces(self, scene: Scene, pixels: int, earlier: Any, later: Any, samples: int) -> Iterator[float]:  # noqa: ANN401
        """Compare two runs of so many samples each, PIECE pixels at a time; yields of each piece the sum, over pixels
        and colours from 0 to 1, of the squared differences."""
        queue, last = self._device.queue, film_arguments(scene, samples)
        apart = np.empty(math.ceil(min(pixels, PIECE) / BLOCK), np.float32)
        target = cl.Buffer(self._device.context, cl.mem_flags.WRITE_ONLY, apart.nbytes)
        for begin in range(0, pixels, PIECE):
            end = min(begin + PIECE, pixels)
            blocks = math.ceil((end - begin) / BLOCK)
            self._kernel(
                queue, (blocks,), (1,), earlier, later, target, np.int32(BLOCK), np.int32(begin), np.int32(end), *last
            )
            cl.enqueue_copy(queue, apart[:blocks], target)
            yield float(apart[:blocks].sum(dtype=float))
