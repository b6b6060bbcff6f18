"""Compile every OpenCL file by itself, and the renderer in all its kinds, with each of clang's warnings an error."""

from __future__ import annotations

import os
import sys

os.environ["PYOPENCL_NO_CACHE"] = "1"  # what was compiled before is no answer

import numpy as np
import pyopencl as cl

import culet_kernels
from culet.rendering.device import Device, open_device
from culet.rendering.features import ESTIMATOR, Geometry
from culet.rendering.program import FLAGS, Variant

# Pragmas, since PoCL refuses -W as an option. A file does not use all of what it includes; and where a packet has one
# lane, the lanes' `&` is one of scalars.
ALL_WARNINGS = """
#pragma clang diagnostic error "-Wall"
#pragma clang diagnostic ignored "-Wunused-function"
#pragma clang diagnostic ignored "-Wbitwise-instead-of-logical"
"""
WIDTHS = (1, 4, 8, 16)
PRECISIONS = (np.float32, np.float64)


def complaints(device: Device, name: str, options: list[str]) -> str:
    """What the compiler says about one file; empty if it is content."""
    program = cl.Program(device.context, ALL_WARNINGS + culet_kernels.source(name))
    try:
        program.build([*FLAGS, "-Werror", *options])
    except cl.Error as error:
        return str(error)
    return ""


def main() -> int:
    """Exit code 1 with the compiler's words if a file does not compile cleanly."""
    device = open_device()
    programs = [(name, Variant().options) for name in culet_kernels.NAMES]
    programs += [
        ("render.cl", [*Variant(lanes=lanes, real=real).options, f"-DGEOMETRY={int(geometry)}", f"-DESTIMATOR={kind}"])
        for geometry in Geometry
        for kind in ESTIMATOR.values()
        for lanes in WIDTHS
        for real in PRECISIONS
    ]
    failures = 0
    for name, options in programs:
        if words := complaints(device, name, options):
            failures += 1
            print(f"{name}: {words}", file=sys.stderr)
    print(f"{len(programs) - failures} of {len(programs)} OpenCL programs compile without a warning")
    return min(failures, 1)


if __name__ == "__main__":
    sys.exit(main())
