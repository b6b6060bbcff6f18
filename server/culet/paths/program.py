"""The program that follows one ray: built, and launched once, since drivers make machine code at the first launch."""

from __future__ import annotations

import sys
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl

from culet.rendering.features import Features
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.compiling import compiling
from culet.rendering.opencl.device import Device, open_device
from culet.rendering.opencl.layout import buffers, struct
from culet.rendering.opencl.making import alone, lacks
from culet.rendering.programs.build import Variant, build, recipe
from culet.rendering.programs.precompile import in_a_process, program_ordered

COMMAND = (sys.executable, "-m", __name__)
"""The process that makes one, which takes the order as its argument."""


class PathKernel(NamedTuple):
    """The kernel `path` of path.cl."""

    entry: Any
    """pyopencl's."""
    kept_bytes: int
    """That it keeps between launches."""


def is_uncached(device: Device, features: Features, variant: Variant) -> bool:
    """Whether another process could put it into the driver's cache, for `make_path` to find it there."""
    return lacks(kernel_cache.folder(), _recipe(device, features, variant))


def precompile_path(features: Features, variant: Variant) -> bool:
    """Have a process of its own make the program, so that the driver's cache has it; whether it did. Somebody waits."""
    return in_a_process(COMMAND, features, variant, urgent=True)


def make_path(device: Device, features: Features, variant: Variant) -> PathKernel:
    """Ready to be launched; errors as of `build`."""
    options = [*variant.options, *features.options]
    with compiling(), alone(kernel_cache.folder(), _recipe(device, features, variant)):
        program = build(device, "path.cl", options)
        queue, flags = cl.CommandQueue(device.context), cl.mem_flags
        size = np.zeros(1, np.int32)
        target = cl.Buffer(device.context, flags.READ_WRITE, size.nbytes)
        cl.Kernel(program, "path_bytes")(queue, (1,), (1,), target)
        cl.enqueue_copy(queue, size, target)
        kept = int(size[0])
        # No step of a pixel that has not begun: nothing is read but what the kernel keeps.
        zeros = flags.READ_WRITE | flags.COPY_HOST_PTR  # of a scene without stones
        scratch = cl.Buffer(
            device.context, zeros, hostbuf=np.zeros(struct("parameters_t", np.float64).itemsize, np.uint8)
        )
        work = cl.Buffer(device.context, zeros, hostbuf=np.zeros(kept, np.uint8))
        nothing = np.int32(0)
        kernel = cl.Kernel(program, "path")
        kernel(
            queue, (1,), (1,), *(scratch for _ in buffers()), scratch, scratch, nothing, nothing, scratch, work,
            nothing, nothing,
        )  # fmt: skip
        queue.finish()
    return PathKernel(kernel, kept)


def _recipe(device: Device, features: Features, variant: Variant) -> str:
    return recipe(device, "path.cl", variant, features)


def main() -> None:
    """Entry of that process."""
    make_path(open_device(), *program_ordered())


if __name__ == "__main__":
    main()
