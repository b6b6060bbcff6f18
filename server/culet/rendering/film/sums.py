"""A picture's samples, summed on the device, and what they tell of its error."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from copy import copy
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.rendering.film.doublings import Doublings
from culet.rendering.opencl.device import Device, Real
from culet.rendering.programs.build import Variant, build

BLOCK = 1024
"""Pixels of a work-item that folds."""
PIECE = 2**21
"""Pixels that are folded at a time: some 15 ms, which is 64 MiB read and 32 MiB written."""


class Fold:
    """The kernel that makes two runs one."""

    def __init__(self, device: Device, variant: Variant) -> None:
        self.queue = device.queue
        self._device, self._variant = device, variant
        self._kernel = cl.Kernel(build(device, "sums.cl", variant.options), "fold")

    def warm_up(self, scratch: Any) -> None:  # noqa: ANN401 - pyopencl has no types
        """Launch once for no pixels."""
        self._kernel(self.queue, (1,), (1,), scratch, scratch, scratch, np.int32(BLOCK), np.int32(0), np.int32(0))

    def pieces(self, earlier: Any, later: Any, pixels: int) -> Iterator[float]:  # noqa: ANN401
        """Add the later run to the earlier, PIECE pixels at a time; yields of each piece the sum of the squared
        differences of the two runs' colours."""
        apart = np.empty(math.ceil(min(pixels, PIECE) / BLOCK), self._variant.real)
        target = cl.Buffer(self._device.context, cl.mem_flags.WRITE_ONLY, apart.nbytes)
        for begin in range(0, pixels, PIECE):
            end = min(begin + PIECE, pixels)
            blocks = math.ceil((end - begin) / BLOCK)
            limits = np.int32(BLOCK), np.int32(begin), np.int32(end)
            self._kernel(self.queue, (blocks,), (1,), earlier, later, target, *limits)
            cl.enqueue_copy(self.queue, apart[:blocks], target)
            yield float(apart[:blocks].sum(dtype=float))


class Sums:
    """Sums of linear radiance in two runs: the first 1, 2, 4, 8 ... samples, and those since.

    Whenever the later run is as long as the earlier, the two are compared and made one. (The even samples against the
    odd ones are worse spread than all of them, and said up to 2.7 times too much.)
    """

    def __init__(self, fold: Fold, allocate: Callable[[int], Any], width: int, height: int, real: Real) -> None:
        """`allocate` makes a buffer of so many bytes on the device: one now, another if there is a second sample."""
        self.samples = 0
        self._fold, self._allocate, self._real = fold, allocate, real
        self._width, self._height = width, height
        self._earlier: Any = allocate(self._size)
        self._later: Any = None
        self.aside: Any = None
        """On the device: the sum of samples that are shown until as many others are there; None: of none."""
        self.samples_aside = 0
        self.radiance = Doublings()
        """Of linear colours."""
        self.shown = Doublings()
        """Of what a screen shows, while `compare_shown` is given."""
        self._aside_radiance, self._aside_shown = Doublings(), Doublings()
        """Of the samples that were put aside."""
        self.compare_shown: Callable[[Any, Any, int], Iterator[float]] | None = None
        """Of two runs of so many samples each: yields, of a part of the picture each time, the sum of the squared
        differences of their means as shown."""

    @property
    def earlier(self) -> int:
        """Samples of the earlier run: the largest power of two that there are."""
        return 1 << max(0, self.samples.bit_length() - 1)

    @property
    def later(self) -> int:
        """Samples of the later run."""
        return max(0, self.samples - self.earlier)

    @property
    def buffers(self) -> tuple[Any, Any]:
        """On the device: sums of the earlier run, and of the later; what is there means nothing without a sample, and
        before the second one both are the same."""
        return self._earlier, self._earlier if self._later is None else self._later

    def restart(self) -> None:
        """Without samples, as at first."""
        self.samples = 0
        self.radiance.clear()
        self.shown.clear()

    def put_aside(self) -> Iterator[None]:
        """The samples that there are do not count any more, but are shown until as many others are there. Those that
        are there begin anew; yields between pieces of work."""
        pixels = self._width * self._height
        if self.later > 0:
            for _ in self._fold.pieces(self._earlier, self._later, pixels):
                yield
        if self.aside is None:
            self.aside, self._earlier = self._earlier, self._allocate(self._size)
        else:
            for _ in self._fold.pieces(self.aside, self._earlier, pixels):
                yield
        self.samples_aside += self.samples
        self._aside_radiance, self._aside_shown = copy(self.radiance), copy(self.shown)
        self.restart()

    def forget_aside(self) -> None:
        """What was put aside is shown no more."""
        self.aside, self.samples_aside = None, 0

    def target(self) -> tuple[Any, bool]:
        """Where the next samples go, and whether they are added to what is there."""
        if self.samples > 0 and self._later is None:
            self._later = self._allocate(self._size)
        return self.buffers[min(1, self.samples)], self.later > 0

    @property
    def room(self) -> int:
        """Samples that the run that the next one goes to still takes, before the two are compared."""
        return 1 if self.samples == 0 else 2 * self.earlier - self.samples

    def added(self, samples: int = 1) -> Iterator[None]:
        """So many samples are there, in all pixels: at most `room`. To be run to its end; yields between pieces of
        work."""
        self.samples += samples
        if self.samples >= self.samples_aside:
            self.forget_aside()
        if self.samples > 1 and self.samples == self.earlier:
            pixels, half = self._width * self._height, self.samples // 2
            if self.compare_shown is not None:
                squared = 0.0
                for piece in self.compare_shown(*self.buffers, half):
                    squared += piece
                    yield
                self.shown.add(self.samples, squared, 3 * pixels)
            squared = 0.0
            for piece in self._fold.pieces(*self.buffers, pixels):
                squared += piece
                yield
            self.radiance.add(self.samples, squared / half**2, 3 * pixels)

    def radiance_error(self) -> float:
        """Estimated root mean square error of the linear colours of what is shown; NaN below two samples."""
        return self._error(self.radiance, self._aside_radiance)

    def shown_error(self) -> float:
        """The same of what a screen shows."""
        return self._error(self.shown, self._aside_shown)

    def _error(self, own: Doublings, aside: Doublings) -> float:
        """Samples that are put aside are made anew one by one: what is shown has as many different ones as they are."""
        return own.error(self.samples) if self.samples_aside == 0 else aside.error(self.samples_aside)

    def mean(self, rows: slice = slice(None)) -> NDArray[np.floating[Any]]:
        """(height, width, 4) of all samples that are shown, or those rows of it; zeros without any sample."""
        counts = self.samples, self.later, self.samples_aside
        sums = zip((*self.buffers, self.aside), counts, strict=True)
        runs = [self._read(buffer, rows) for buffer, count in sums if count]
        height = len(range(*rows.indices(self._height)))
        count = max(1, self.samples + self.samples_aside)
        return sum(runs, np.zeros((height, self._width, 4), self._real)) / self._real(count)

    @property
    def _size(self) -> int:
        """Bytes of a run."""
        return self._width * self._height * 4 * np.dtype(self._real).itemsize

    def _read(self, buffer: Any, rows: slice) -> NDArray[np.floating[Any]]:  # noqa: ANN401
        begin, end, _ = rows.indices(self._height)
        sums = np.empty((end - begin, self._width, 4), self._real)
        cl.enqueue_copy(self._fold.queue, sums, buffer, src_offset=begin * sums.itemsize * self._width * 4)
        return sums
