"""Programs by features: built once, ready when they have been launched, made in the background meanwhile."""

from __future__ import annotations

import logging
import math
import threading
import time

from culet.errors import KernelCacheError
from culet.rendering.features import Features
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.compiling import compiling
from culet.rendering.opencl.device import Device
from culet.rendering.programs.build import Kernel, Variant, is_uncached, make
from culet.rendering.programs.precompile import precompile

log = logging.getLogger(__name__)

RETRY_SECONDS = 30.0
"""Until a program is tried again that could not be written."""


class Programs:
    """Kernels by features and variant, for one device.

    PoCL makes machine code at the first launch, for that shape of work-group; so a kernel counts as ready when it has
    been launched once.
    """

    def __init__(self, device: Device, *, apart: bool = False) -> None:
        """None is ready. `apart`: `prepare` has the first one, too, compiled by a process of its own."""
        self._device = device
        self._apart = apart
        self._ready: dict[tuple[Features, Variant], Kernel] = {}
        self._next_try: dict[tuple[Features, Variant], float] = {}
        """s, steady clock: of those made in the background, or tried in vain, when they may be tried again."""
        self._compiler = threading.Lock()
        self._turns = {urgent: threading.Lock() for urgent in (True, False)}
        """For those who wait for a program, and in the background: of each kind one is made at a time."""

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
        its own, unless the driver's cache has it, or there is nothing yet that could be launched. One at a time: a
        compiler takes 200 MiB."""
        with self._turns[urgent]:
            if self.is_ready(features, variant):
                return
            if (self._apart or self._ready) and self._is_uncached(features, variant):
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
        if not kernel_cache.has_plenty_of_room():
            self._make_in_a_process_of_its_own(features, variant)
        return make(self._device, features, variant)

    def _is_uncached(self, features: Features, variant: Variant) -> bool:
        return is_uncached(self._device, features, variant)

    def _make_in_a_process_of_its_own(self, features: Features, variant: Variant) -> None:
        """Where there is little room the compiler may end its process: not this one. Then what is made is there."""
        if not precompile(features, variant, urgent=True) and (fault := kernel_cache.complaint()):
            raise KernelCacheError(fault)
