"""Programs by features: built once, ready when they have been launched, made in the background meanwhile."""

from __future__ import annotations

import logging
import math
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl

import culet_kernels
from culet.errors import DeviceError, KernelCacheError
from culet.rendering import kernel_cache
from culet.rendering.compiling import compiling
from culet.rendering.device import Device, Real
from culet.rendering.features import Features
from culet.rendering.layout import arguments, constants, in_order, struct
from culet.rendering.making import alone

log = logging.getLogger(__name__)

FLAGS = ("-cl-std=CL1.2", "-cl-fast-relaxed-math", "-cl-mad-enable")


RETRY_SECONDS = 30.0
"""Until a program is tried again that could not be written."""

TILE = 32
"""Pixels on each side of what a core renders at a time."""


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
            f"-DTILE={TILE}",
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


class Programs:
    """Kernels by features and variant, for one device.

    PoCL makes machine code at the first launch, for that shape of work-group; so a kernel counts as ready when it has
    been launched once.
    """

    def __init__(self, device: Device, *, own_process: bool = False) -> None:
        """`own_process`: this one is there for nothing else than to make a program."""
        self._device = device
        self._own_process = own_process
        self._ready: dict[tuple[Features, Variant], Kernel] = {}
        self._next_try: dict[tuple[Features, Variant], float] = {}
        """s, steady clock: of those made in the background, or tried in vain, when they may be tried again."""
        self._compiler = threading.Lock()

    def exact(self, features: Features, variant: Variant) -> Kernel:
        """The kernel for just these features; waits for the compiler if need be."""
        key = features, variant
        kernel = self._ready.get(key)
        if kernel is None:
            with self._compiler:
                with compiling():
                    kernel = self._ready.get(key) or self._make(features, variant)
                self._ready[key] = kernel
        return kernel

    def is_ready(self, features: Features, variant: Variant) -> bool:
        """Whether `exact` would not wait."""
        return (features, variant) in self._ready

    def prepare(self, features: Features, variant: Variant, *, urgent: bool = True) -> None:
        """Make the kernel for just these features ready, and keep launches waiting as little as can be: by a process of
        its own, unless there is nothing yet that could be launched."""
        from culet.rendering.precompile import precompile  # which imports this module

        if self.is_ready(features, variant):
            return
        if self._ready:
            precompile(features, variant, urgent=urgent)
        self.exact(features, variant)

    def best(self, features: Features, variant: Variant) -> Kernel:
        """The kernel for these features if it is ready; else the general one, while the special one is made.

        That is tried once: where it fails, the general one goes on serving; but tried again later where the driver
        could not write what it compiles.
        """
        key = features, variant
        kernel = self._ready.get(key)
        if kernel is not None:
            return kernel
        general = self.exact(features.general, variant)
        if self._next_try.get(key, -math.inf) <= time.monotonic():
            self._next_try[key] = math.inf
            threading.Thread(target=self._make_ready, args=key, name="culet-compile", daemon=True).start()
        return general

    def _make_ready(self, features: Features, variant: Variant) -> None:
        try:
            self.prepare(features, variant, urgent=False)
        except KernelCacheError as error:
            self._next_try[features, variant] = time.monotonic() + RETRY_SECONDS
            log.error("the general program goes on serving: %s", error)
        except Exception:  # drivers fail in every way; another try with each frame would fail as well
            log.exception("the general program goes on serving: the special one cannot be made (%s)", features)

    def _make(self, features: Features, variant: Variant) -> Kernel:
        if not self._own_process and not kernel_cache.has_plenty_of_room():
            self._make_in_a_process_of_its_own(features, variant)
        options = [*variant.options, *features.options]
        with alone(kernel_cache.folder(), f"{culet_kernels.source('render.cl')} {options}"):
            program = build(self._device, "render.cl", options)
            kept_bytes = warm_up(self._device, cl.Kernel(program, "render"))
        return Kernel(cl.Kernel(program, "render"), kept_bytes)

    def _make_in_a_process_of_its_own(self, features: Features, variant: Variant) -> None:
        """Where there is little room the compiler may end its process: not this one. Then what is made is there."""
        from culet.rendering.precompile import precompile  # as above

        if not precompile(features, variant, urgent=True) and (fault := kernel_cache.complaint()):
            raise KernelCacheError(fault)


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
