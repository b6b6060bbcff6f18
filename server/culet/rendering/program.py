"""Programs by features: built once, ready when they have been launched, made in the background meanwhile."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl

import culet_kernels
from culet.errors import DeviceError
from culet.rendering.device import Device, Real
from culet.rendering.features import Features

FLAGS = ("-cl-std=CL1.2", "-cl-fast-relaxed-math", "-cl-mad-enable")


@dataclass(frozen=True)
class Variant:
    """What names a program besides its features."""

    lanes: int = 16
    real: Real = np.float32
    tile: int = 32

    @property
    def options(self) -> list[str]:
        """For the compiler."""
        return [
            f"-DLANES={self.lanes}",
            f"-DREAL={'double' if self.real is np.float64 else 'float'}",
            f"-DTILE={self.tile}",
        ]


def build(device: Device, name: str, options: list[str]) -> Any:  # noqa: ANN401 - pyopencl has no types
    """Compile one source file; DeviceError carries the compiler's words."""
    try:
        return cl.Program(device.context, culet_kernels.source(name)).build([*FLAGS, *options])
    except cl.Error as error:
        raise DeviceError(f"{name} does not build with {' '.join(options)}:\n{error}") from error


class Programs:
    """Kernels by features and variant, for one device.

    PoCL makes machine code at the first launch, for that shape of work-group; so a kernel counts as ready when it has
    been launched once.
    """

    def __init__(self, device: Device) -> None:
        self._device = device
        self._ready: dict[tuple[Features, Variant], Any] = {}
        self._making: set[tuple[Features, Variant]] = set()
        self._compiler = threading.Lock()

    def exact(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401
        """The kernel for just these features; waits for the compiler if need be."""
        key = features, variant
        kernel = self._ready.get(key)
        if kernel is None:
            with self._compiler:
                kernel = self._ready.get(key) or self._make(features, variant)
                self._ready[key] = kernel
        return kernel

    def best(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401
        """The kernel for these features if it is ready; else the general one, while the special one is made."""
        key = features, variant
        kernel = self._ready.get(key)
        if kernel is not None:
            return kernel
        general = self.exact(features.general, variant)
        if key not in self._making:
            self._making.add(key)
            threading.Thread(target=self._make_ready, args=key, name="culet-compile", daemon=True).start()
        return general

    def _make_ready(self, features: Features, variant: Variant) -> None:
        from culet.rendering.precompile import precompile  # which imports this module

        try:
            precompile(features, variant)
            self.exact(features, variant)
        finally:
            self._making.discard((features, variant))

    def _make(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401
        program = build(self._device, "render.cl", [*variant.options, *features.options])
        kernel = cl.Kernel(program, "render")
        warm_up(self._device, kernel)
        return cl.Kernel(program, "render")


def dealer(device: Device) -> Any:  # noqa: ANN401 - pyopencl has no types
    """What deals the tiles of one launch at a time out to the device's cores; see tile.cl."""
    flags = cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR
    return cl.Buffer(device.context, flags, hostbuf=np.zeros(2, np.uint32))


def warm_up(device: Device, kernel: Any) -> None:  # noqa: ANN401
    """Launch once for no tiles, in a queue of its own."""
    queue = cl.CommandQueue(device.context)
    scratch = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, 1024)
    real, integer = np.float64(0), np.int32(0)
    kernel(queue, (1,), (1,), *[scratch] * 9, real, real, integer, integer, dealer(device), integer, scratch)
    queue.finish()
