"""What a screen may leave out: pixels that a single sample has made bright.

Such a firefly is a path that is rare and very bright, so that its pixel is wrong until very many samples are taken;
fire is seen by more samples of its pixel than one. A pixel's brightest sample is left out where it is RATIO times as
bright as the next one: a test of outliers by the density of samples about them (C. DeCoro et al., Density-based Outlier
Rejection in Monte Carlo Rendering, 2010), among the luminances of one pixel. What is left out is light that was there:
the mean of such a picture is too dark, so this is for looking at, and not for measuring (docs/explanation/accuracy.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pyopencl as cl

from culet.rendering.opencl.device import Device, Real
from culet.rendering.programs.build import Variant, build

RATIO = 8.0
"""Luminance of a firefly over that of the pixel's next brightest sample."""
LEAST_SHOWN = 0.02
"""Of white: what a firefly adds to the mean of its pixel's samples, at least. Less is not seen."""
LEAST_SAMPLES = 8
"""Of fewer, one is too large a part for it to be told whether it stands alone."""
BLOCK = 1024
"""Pixels of a work-item."""
PIECE = 2**19
"""Pixels of a launch."""


class FireflyKernels:
    """Of one device and precision; made when the first picture asks for them."""

    def __init__(self, device: Device, variant: Variant) -> None:
        program = build(device, "fireflies.cl", variant.options)
        self.queue, self.real = device.queue, variant.real
        self.collect = cl.Kernel(program, "collect")
        self.without = cl.Kernel(program, "without_fireflies")


class Fireflies:
    """Of one picture: its samples, one at a time, on their way to its sums."""

    def __init__(self, kernels: FireflyKernels, allocate: Callable[[int], Any], pixels: int, exposure: float) -> None:
        """`allocate` makes a buffer of so many bytes on the device; `exposure` is the film's."""
        self._kernels, self._pixels, self._exposure = kernels, pixels, exposure
        size = 4 * pixels * np.dtype(kernels.real).itemsize
        self.sample, self._brightest, self._kept = allocate(size), allocate(size), allocate(size)
        self._second = allocate(size // 4)

    def collect(self, run: Any, *, add: bool, sample: int) -> None:  # noqa: ANN401 - pyopencl has no types
        """`sample` of all pixels is in `self.sample`: into a run of samples with it, added to what is there or not."""
        self._launch(
            self._kernels.collect, self.sample, run, np.int32(add), self._brightest, self._second, np.int32(sample == 0)
        )

    def left_out(self, earlier: Any, later: Any, samples: int, *, both: bool) -> Any:  # noqa: ANN401
        """The sums of the samples of both runs, or of the earlier, without fireflies: a buffer that is there until the
        next call."""
        real: Real = self._kernels.real
        least = LEAST_SHOWN * samples / self._exposure
        self._launch(
            self._kernels.without, earlier, later, np.int32(both), self._brightest, self._second, self._kept,
            real(samples), real(RATIO), real(least if samples >= LEAST_SAMPLES else math.inf),
        )  # fmt: skip
        return self._kept

    def _launch(self, kernel: Any, *arguments: Any) -> None:  # noqa: ANN401
        for begin in range(0, self._pixels, PIECE):
            end = min(begin + PIECE, self._pixels)
            blocks = math.ceil((end - begin) / BLOCK)
            kernel(self._kernels.queue, (blocks,), (1,), *arguments, np.int32(BLOCK), np.int32(begin), np.int32(end))
