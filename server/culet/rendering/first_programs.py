"""The programs that each engine needs before its first picture, made in a process of their own where the driver's cache
does not have them: a compiler leaves some 150 MiB in the process in which it has been at work."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import culet_kernels
from culet.errors import DeviceError
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.apart import ordered, run_apart
from culet.rendering.opencl.compiling import compiling
from culet.rendering.opencl.making import alone, lacks

COMMAND = (sys.executable, "-m", __name__)


@contextmanager
def made_apart() -> Iterator[None]:
    """Have them made beside what is done meanwhile, as importing modules, and wait for them. Where that fails, they
    are compiled in this process, which hears why."""
    if not lacks(kernel_cache.folder(), _recipe()):
        yield
        return

    def work() -> None:
        with compiling(), suppress(DeviceError):
            run_apart(COMMAND, {})

    making = threading.Thread(target=work, name="first-programs", daemon=True)
    making.start()
    yield
    making.join()


def _recipe() -> str:
    """Of them; another driver comes with another file that names it."""
    sources = [culet_kernels.source(name) for name in ("film.cl", "sums.cl", "render.cl")]
    vendors = Path(os.environ.get("OCL_ICD_VENDORS", "/etc/OpenCL/vendors"))
    drivers = sorted((each.name, each.stat().st_mtime_ns) for each in vendors.glob("*.icd"))
    return f"{sources} {os.environ.get('CULET_DEVICE')} {drivers}"


def main() -> None:
    """Entry of that process."""
    ordered()
    from culet.rendering.renderer import Renderer

    with alone(kernel_cache.folder(), _recipe()):
        Renderer().prepare()


if __name__ == "__main__":
    main()
