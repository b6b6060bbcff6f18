"""What the machine can do at most, measured by kernels that do nothing else: what share of it does a picture take?"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl

from culet.rendering.opencl.device import Device, Real
from culet.rendering.programs.build import Variant, build

ACCUMULATORS = 12
"""As in roofline.cl."""
FMA_PER_FACET = 6
"""Of a segment inside: a dot product with the direction, and one with the origin."""
COPY_BYTES = 2**27
"""Of each of the two buffers: together several times the caches of a large processor."""
FACTOR, TERM = 0.5, 1.0
"""Every accumulator tends to TERM / (1 - FACTOR) = 2."""


class Roofline(NamedTuple):
    """Of one device in a second: all its units together, or, by the processor's time, one of them."""

    single_flops: float
    """Additions and multiplications a second in single precision, two for each fused multiply-add."""
    double_flops: float
    bandwidth_per_second: float
    """Bytes read and written, of a copy."""


def measure_roofline(device: Device, repeats: int = 5, clock: Callable[[], float] = time.perf_counter) -> Roofline:
    """Takes the best of `repeats`: a limit is what nothing else has disturbed. Some second. `clock` tells seconds: by
    that of the process's own time the limits are those of one unit."""
    return Roofline(
        _flops(device, np.float32, repeats, clock),
        _flops(device, np.float64, repeats, clock),
        _bandwidth(device, repeats, clock),
    )


def counted_flops(segments: float, facets: int) -> float:
    """Of the search for the facet that each segment ends at, if each facet is asked by itself, without all the rest. By
    symmetry (rendering/stones/facet_rows.py) it takes less."""
    return segments * facets * FMA_PER_FACET * 2


def _flops(device: Device, real: Real, repeats: int, clock: Callable[[], float]) -> float:
    lanes, items, rounds = device.lanes_for(real), 16 * device.units, 20_000
    kernel = _kernel(device, "multiply_add", real)
    result = cl.Buffer(device.context, cl.mem_flags.WRITE_ONLY, items * lanes * np.dtype(real).itemsize)

    def run() -> None:
        kernel(device.queue, (items,), (1,), result, real(FACTOR), real(TERM), np.int32(rounds)).wait()

    seconds = _fastest(run, repeats, clock)
    found = np.empty(items * lanes, real)
    cl.enqueue_copy(device.queue, found, result)
    if not np.allclose(found, ACCUMULATORS * TERM / (1 - FACTOR)):
        raise ArithmeticError(f"multiply_add: expected {ACCUMULATORS * TERM / (1 - FACTOR)}, got {found[:4]}")
    return 2.0 * items * rounds * ACCUMULATORS * lanes / seconds


def _bandwidth(device: Device, repeats: int, clock: Callable[[], float]) -> float:
    real: Real = np.float32
    lanes, items = device.lanes_for(real), 4 * device.units
    packets = COPY_BYTES // (items * lanes * np.dtype(real).itemsize)
    count = packets * items * lanes
    kernel = _kernel(device, "copy", real)
    source = np.arange(count, dtype=real)
    flags = cl.mem_flags
    origin = cl.Buffer(device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=source)
    target = cl.Buffer(device.context, flags.WRITE_ONLY, source.nbytes)

    def run() -> None:
        kernel(device.queue, (items,), (1,), origin, target, np.int32(packets)).wait()

    return 2.0 * source.nbytes / _fastest(run, repeats, clock)


def _kernel(device: Device, name: str, real: Real) -> Any:  # noqa: ANN401 - pyopencl has no types
    return cl.Kernel(build(device, "roofline.cl", Variant(lanes=device.lanes_for(real), real=real).options), name)


def _fastest(run: Callable[[], None], repeats: int, clock: Callable[[], float]) -> float:
    run()  # compiles, and touches every page
    seconds = []
    for _ in range(repeats):
        start = clock()
        run()
        seconds.append(clock() - start)
    return min(seconds)
