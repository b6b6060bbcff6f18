"""Programs by features: built once, ready when they have been launched, made in the background meanwhile."""

from __future__ import annotations

import logging
import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl

import culet_kernels
from culet.errors import DeviceError
from culet.rendering.compiling import compiling
from culet.rendering.device import Device, Real, pocl_cache
from culet.rendering.features import Features
from culet.rendering.making import alone
from culet.rendering.parameters import layout

log = logging.getLogger(__name__)

FLAGS = ("-cl-std=CL1.2", "-cl-fast-relaxed-math", "-cl-mad-enable")


TILE = 32
"""Pixels on each side of what a core renders at a time."""


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
            f"-DTILE={TILE}",
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
        self._begun: set[tuple[Features, Variant]] = set()
        """Made in the background, or tried in vain."""
        self._compiler = threading.Lock()

    def exact(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401
        """The kernel for just these features; waits for the compiler if need be."""
        key = features, variant
        kernel = self._ready.get(key)
        if kernel is None:
            with self._compiler:
                with compiling():
                    kernel = self._ready.get(key) or self._make(features, variant)
                self._ready[key] = kernel
        return kernel

    def best(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401
        """The kernel for these features if it is ready; else the general one, while the special one is made.

        That is tried once: where it fails, the general one goes on serving.
        """
        key = features, variant
        kernel = self._ready.get(key)
        if kernel is not None:
            return kernel
        general = self.exact(features.general, variant)
        if key not in self._begun:
            self._begun.add(key)
            threading.Thread(target=self._make_ready, args=key, name="culet-compile", daemon=True).start()
        return general

    def _make_ready(self, features: Features, variant: Variant) -> None:
        from culet.rendering.precompile import precompile  # which imports this module

        try:
            precompile(features, variant)
            self.exact(features, variant)
        except Exception:  # drivers fail in every way; another try with each frame would fail as well
            log.exception("the general program goes on serving: the special one cannot be made (%s)", features)

    def _make(self, features: Features, variant: Variant) -> Any:  # noqa: ANN401
        options = [*variant.options, *features.options]
        with alone(pocl_cache(), f"{culet_kernels.source('render.cl')} {options}"):
            program = build(self._device, "render.cl", options)
            kernel = cl.Kernel(program, "render")
            warm_up(self._device, kernel)
        return cl.Kernel(program, "render")


def warm_up(device: Device, kernel: Any) -> None:  # noqa: ANN401
    """Launch once for no tiles, in a queue of its own."""
    queue = cl.CommandQueue(device.context)
    size = layout(np.float64).itemsize  # of the largest argument that is read: a scene in either precision
    scratch = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, size)
    real, integer = np.float64(0), np.int32(0)
    kernel(queue, (1,), (1,), *[scratch] * 9, real, real, integer, integer, scratch, integer, scratch)
    queue.finish()
