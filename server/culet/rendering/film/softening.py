"""What stands in for more samples while there is but one of each pixel: a filter of three pixels by three."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.rendering.opencl.device import Device

GROUP = 16
"""Rows of a work-group. Always as many, or PoCL would make machine code anew for many a picture's height."""


class Softening:
    """Weighs each pixel 6 : 1 with the pixel on either side, along rows and along columns.

    One sample of a pixel takes steps at edges that many samples would round off. As shown, filtered so, it is as near
    to the converged picture as two samples are, whose rendering takes twice as long (docs/explanation/performance.md).
    """

    def __init__(self, device: Device, program: Any, allocate: Callable[[int], Any]) -> None:  # noqa: ANN401 - pyopencl has no types
        """`program` is film.cl's; `allocate` gives a buffer of so many bytes."""
        self._device, self._allocate = device, allocate
        self._kernel = cl.Kernel(program, "soften")

    def warm_up(self, scratch: Any) -> None:  # noqa: ANN401
        """Launch once for no rows."""
        none = np.int32(0)
        self._kernel(self._device.queue, (GROUP,), (GROUP,), scratch, scratch, none, none)

    def softened(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """(height, width, 3) of a picture of that shape, 8 bits."""
        given = self._allocate(rgb.nbytes)
        cl.enqueue_copy(self._device.queue, given, np.ascontiguousarray(rgb))
        return self.read(given, rgb.shape[1], rgb.shape[0])

    def read(self, developed: Any, width: int, height: int) -> NDArray[np.uint8]:  # noqa: ANN401
        """(height, width, 3) of a picture that is on the device, 8 bits."""
        queue, made = self._device.queue, np.empty((height, width, 3), np.uint8)
        target = self._allocate(made.nbytes)
        rows = math.ceil(height / GROUP) * GROUP
        self._kernel(queue, (rows,), (GROUP,), developed, target, np.int32(width * 3), np.int32(height))
        cl.enqueue_copy(queue, made, target)
        return made
