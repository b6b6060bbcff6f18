"""An OpenCL device that is known to work."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict, deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.errors import DeviceError
from culet.optics.panoramas import check_panorama
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.driver_package import how_to_install
from culet.rendering.opencl.processors import limit_threads

Real = type[np.float32] | type[np.float64]
"""The precision of a program."""

MOST_PANORAMAS = 4
"""That stay on the device at a time."""

_PROBE = """
__kernel void probe(__global float4 *a) {
  const size_t i = get_global_id(0);
  a[i] = sqrt(a[i]) + (float4)((float)i);
}
"""


@dataclass(frozen=True, eq=False)
class Device:
    """A device, its context, and how many lanes a packet should have on it."""

    context: Any
    queue: Any
    name: str
    driver: str
    lanes: int
    """Of single precision; double precision has half as many."""
    units: int
    shares_memory: bool = False
    """It reads what lies in this process's memory, so that a sky is not copied for it."""
    panoramas: OrderedDict[int, tuple[NDArray[np.float32], Any]] = field(default_factory=OrderedDict, repr=False)
    """Skies that are on the device, the latest used last: by the array's identity, with the array, which keeps it."""
    lock: threading.Lock = field(default_factory=threading.Lock, repr=False)
    """Of the panoramas: one thread renders, another may forget."""

    def panorama(self, pixels: NDArray[np.float32]) -> Any:  # noqa: ANN401 - pyopencl has no types
        """The buffer of a sky, which is uploaded once and not for every picture. InputError if it is no sky."""
        with self.lock:
            known = self.panoramas.get(id(pixels))
            if known is not None:
                self.panoramas.move_to_end(id(pixels))
                return known[1]
        check_panorama(pixels)
        own = np.ascontiguousarray(pixels, np.float32)
        place = cl.mem_flags.USE_HOST_PTR if self._shared(own, pixels) else cl.mem_flags.COPY_HOST_PTR
        buffer = cl.Buffer(self.context, cl.mem_flags.READ_ONLY | place, hostbuf=own)
        with self.lock:
            self.panoramas[id(pixels)] = pixels, buffer
            while len(self.panoramas) > MOST_PANORAMAS:
                self.panoramas.popitem(last=False)
        return buffer

    def forget(self, pixels: NDArray[np.float32]) -> None:
        """A sky that is not needed any more; pictures that are being made of it go on."""
        with self.lock:
            self.panoramas.pop(id(pixels), None)

    def panorama_bytes(self) -> int:
        """Memory of the skies on the device, but for those that it reads where they are."""
        with self.lock:
            return sum(pixels.nbytes for pixels, _ in self.panoramas.values() if not self._shared(pixels, pixels))

    def _shared(self, own: NDArray[np.float32], given: NDArray[np.float32]) -> bool:
        """An array that somebody might write to is copied: a picture shows the sky as it was when it was begun."""
        return self.shares_memory and own is given and not given.flags.writeable

    def lanes_for(self, real: Real) -> int:
        """Lanes of a packet in that precision."""
        return self.lanes if real is np.float32 else max(1, self.lanes // 2)


_opening: deque[Future[Device]] = deque(maxlen=1)
"""What was begun in advance, until it is asked for."""


def open_in_advance() -> None:
    """Begin to open the device in a thread of its own: a driver is at it without the interpreter, which imports modules
    meanwhile. The next `open_device` waits for that one. The process does not end before it is open."""
    opening: Future[Device] = Future()

    def work() -> None:
        try:
            opening.set_result(_opened())
        except BaseException as error:
            opening.set_exception(error)

    _opening.append(opening)
    threading.Thread(target=work, name="open-device").start()


def open_device() -> Device:
    """The first device, processors before others, that builds, runs and gets a small kernel right.

    CULET_DEVICE, a part of a device's or platform's name, narrows the choice. Listing platforms is not enough: a driver
    can be installed and yet fail to build anything. DeviceError says what was tried.
    """
    try:
        opening = _opening.pop()
    except IndexError:
        return _opened()
    return opening.result()


def _opened() -> Device:
    wanted = os.environ.get("CULET_DEVICE", "").lower()
    tried: list[str] = []
    limit_threads()
    try:
        platforms = cl.get_platforms()
    except cl.Error as error:
        raise DeviceError(f"no OpenCL platform is installed ({error}); {how_to_install()}") from error
    candidates = [device for platform in platforms for device in platform.get_devices()]
    candidates.sort(key=lambda device: not device.type & cl.device_type.CPU)
    for candidate in candidates:
        name = f"{candidate.name.strip()} | {candidate.platform.version.strip()}"
        if wanted not in name.lower() and wanted not in candidate.platform.name.lower():
            continue
        try:
            context = cl.Context([candidate])
            queue = cl.CommandQueue(context)
            _probe(context, queue)
        except Exception as error:  # drivers fail in every way; the next one may work
            tried.append(f"{name}: {str(error).splitlines()[0]}")
            continue
        width = candidate.native_vector_width_float
        lanes = max(lane for lane in (1, 4, 8, 16) if lane <= max(1, width))
        return Device(
            context, queue, candidate.name.strip(), candidate.platform.version.strip(), lanes,
            candidate.max_compute_units, shares_memory=bool(candidate.host_unified_memory),
        )  # fmt: skip
    if not tried:
        tried = [f"none matches CULET_DEVICE={wanted!r}" if wanted and candidates else "the drivers offer none"]
    raise DeviceError(f"no OpenCL device works ({'; '.join(tried)}); {remedy(candidates)}")


def remedy(found: Sequence[Any]) -> str:
    """What to do if none of the devices found works. Without a folder for its machine code PoCL 3.1 offers none, and
    does not say why."""
    if found_fault := kernel_cache.complaint():
        return found_fault
    if found:
        return "clinfo shows what there is; CULET_DEVICE chooses among it by name"
    return how_to_install()


def _probe(context: Any, queue: Any) -> None:  # noqa: ANN401 - pyopencl has no types
    values = np.arange(64, dtype=np.float32)
    buffer = cl.Buffer(context, cl.mem_flags.READ_WRITE | cl.mem_flags.COPY_HOST_PTR, hostbuf=values)
    cl.Kernel(cl.Program(context, _PROBE).build(), "probe")(queue, (16,), None, buffer)
    result = np.empty_like(values)
    cl.enqueue_copy(queue, result, buffer)
    expected = np.sqrt(values) + np.repeat(np.arange(16), 4)
    if not np.allclose(result, expected, rtol=1e-5):
        raise DeviceError(f"computes wrong: expected {expected[:4]}, got {result[:4]}")
