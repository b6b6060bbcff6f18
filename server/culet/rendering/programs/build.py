"""One program: compiled from its source for its features, and launched once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl

import culet_kernels
from culet.errors import DeviceError, KernelCacheError
from culet.rendering.features import Features, StoneCount
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.device import Device, Real
from culet.rendering.opencl.layout import arguments, constants, in_order, struct
from culet.rendering.opencl.making import alone, lacks

FLAGS = ("-cl-std=CL1.2", "-cl-fast-relaxed-math", "-cl-mad-enable")


def tile_of(features: Features) -> int:
    """Pixels on each side of what a core renders at a time."""
    return constants("tile.cl")["TILE_OF_MANY" if features.stones == StoneCount.MANY else "TILE_OF_ONE"]


TILES_DEALT, WORK_BYTES, OF_ITEMS, ITEM_NUMBERS = (
    constants("tile.cl")[name] for name in ("TILES_DEALT", "WORK_BYTES", "OF_ITEMS", "ITEM_NUMBERS")
)
"""Where a sample's progress has what; then for each work-item whether it keeps a tile that is not done, and how many
steps it has made in the last launch."""


def progress_size(units: int) -> int:
    """Numbers of the progress of a sample to which so many work-items see."""
    return OF_ITEMS + ITEM_NUMBERS * units


@dataclass(frozen=True, eq=False)
class Kernel:
    """The render kernel of one program."""

    entry: Any
    """pyopencl's."""
    kept_bytes: int
    """That a work-item keeps of a tile under way."""
    features: Features
    """That it was made for: the general ones serve others too, and read what those of their own would not."""

    def launch(self, queue: Any, items: int, given: Mapping[str, object]) -> Any:  # noqa: ANN401 - pyopencl has no types
        """So many work-items, with the arguments by name; returns the event."""
        return self.entry(queue, (items,), (1,), *in_order(given))


@dataclass(frozen=True)
class Variant:
    """What names a program besides its features."""

    lanes: int = 16
    real: Real = np.float32

    @property
    def options(self) -> list[str]:
        """For the compiler."""
        return [
            f"-DLANES={self.lanes}",
            f"-DREAL={'double' if self.real is np.float64 else 'float'}",
        ]


def build(device: Device, name: str, options: list[str]) -> Any:  # noqa: ANN401 - pyopencl has no types
    """Compile one source file; DeviceError carries the compiler's words, KernelCacheError those about its folder."""

    def built() -> Any:  # noqa: ANN401
        return cl.Program(device.context, culet_kernels.source(name)).build([*FLAGS, *options])

    try:
        try:
            return built()
        except cl.Error:
            if not kernel_cache.restore():
                raise
            return built()
    except cl.Error as error:
        if fault := kernel_cache.complaint():
            raise KernelCacheError(fault) from error
        raise DeviceError(f"{name} does not build with {' '.join(options)}:\n{error}") from error


def make(device: Device, features: Features, variant: Variant) -> Kernel:
    """The render kernel for just these features, ready to be launched; errors as of `build`."""
    with alone(kernel_cache.folder(), _recipe(device, features, variant)):
        program = build(device, "render.cl", [*variant.options, *features.options])
        kept_bytes = warm_up(device, cl.Kernel(program, "render"))
    return Kernel(cl.Kernel(program, "render"), kept_bytes, features)


def is_uncached(device: Device, features: Features, variant: Variant) -> bool:
    """Whether another process could put it into the driver's cache, for `make` to find it there."""
    return lacks(kernel_cache.folder(), _recipe(device, features, variant))


def _recipe(device: Device, features: Features, variant: Variant) -> str:
    return recipe(device, "render.cl", variant, features)


def recipe(device: Device, source: str, *choices: object) -> str:
    """All that a program, which is made of a source file by some choices, depends on."""
    return f"{device.name} {device.driver} {culet_kernels.source(source)} {choices}"


def warm_up(device: Device, kernel: Any) -> int:  # noqa: ANN401
    """Launch once for no tiles, in a queue of its own; the bytes that a work-item keeps of a tile under way."""
    queue = cl.CommandQueue(device.context)
    size = struct("parameters_t", np.float64).itemsize  # of the largest argument that is read, in either precision
    scratch = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, size)
    progress = np.zeros(progress_size(1), np.uint32)
    target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR, hostbuf=progress)
    given: dict[str, object] = {each.name: scratch if each.scalar is None else 0 for each in arguments()}
    kernel(queue, (1,), (1,), *in_order({**given, "progress": target, "steps": 1}))
    cl.enqueue_copy(queue, progress, target)
    return int(progress[WORK_BYTES])
