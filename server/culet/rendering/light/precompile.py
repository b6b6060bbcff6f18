"""Makes the programs of a stage's light in a process of its own, so that the driver's cache has them."""

from __future__ import annotations

import pickle
import sys

import pyopencl as cl

from culet.rendering.light.lighting import Lighting
from culet.rendering.opencl.apart import ordered
from culet.rendering.opencl.device import open_device


def main() -> None:
    """Entry of that process: its standard input is the stage, as the process wrote it that started this one."""
    ordered()
    device = open_device()
    lighting = Lighting(device, lambda size: cl.Buffer(device.context, cl.mem_flags.READ_WRITE, size))
    lighting.make_ready(pickle.load(sys.stdin.buffer))  # noqa: S301 - nobody else can write there


if __name__ == "__main__":
    main()
