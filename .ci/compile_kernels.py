"""Compile every OpenCL file by itself, and the renderer in all its kinds, with each of clang's warnings an error.

Programs in every width of a packet and both precisions, on all cores. No test does that again.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from itertools import product
from multiprocessing import get_context

os.environ["PYOPENCL_NO_CACHE"] = "1"  # what was compiled before is no answer

import numpy as np
import pyopencl as cl

import culet_kernels
from culet.rendering.features import ESTIMATOR, FRESNEL, SKY, SURFACE, Features, Geometry, StoneCount
from culet.rendering.opencl.device import Device, open_device
from culet.rendering.programs.build import FLAGS, Variant

# Pragmas, since PoCL refuses -W as an option. A file does not use all of what it includes; and where a packet has one
# lane, the lanes' `&` is one of scalars.
ALL_WARNINGS = """
#pragma clang diagnostic error "-Wall"
#pragma clang diagnostic ignored "-Wunused-function"
#pragma clang diagnostic ignored "-Wbitwise-instead-of-logical"
"""
VARIANTS = [Variant(lanes=lanes, real=real) for lanes in (1, 4, 8, 16) for real in (np.float32, np.float64)]
BY_ITSELF = VARIANTS[0], VARIANTS[-1]
"""One lane in single precision and sixteen in double, of a file without kernels: whether it includes what it uses. In
the others it is compiled in the programs that include it."""
FIXED = [
    Features(
        Geometry.HULL, SURFACE["mirror"], SURFACE["none"], -1, SKY["studio"], dispersion=1, absorption=0,
        fresnel=FRESNEL["exact"], camera_inside=0,
    ),
    Features(
        Geometry.MESH, SURFACE["matte"], SURFACE["mirror"], 0, SKY["half"], dispersion=0, absorption=-1,
        fresnel=FRESNEL["schlick"], camera_inside=1,
    ),
    Features(
        Geometry.EMPTY, SURFACE["none"], SURFACE["none"], 0, SKY["constant"], dispersion=0, absorption=0,
        fresnel=FRESNEL["exact"], camera_inside=0,
    ),
]  # fmt: skip
"""All decided when the program is made, each of their kinds at least once."""
MANY = [
    Features(Geometry.HULL, stones=StoneCount.MANY),
    Features(Geometry.HULL, stones=StoneCount.MANY, alike=1),
    Features(Geometry.MESH, stones=StoneCount.MANY, few_mirrors=1),
    Features(Geometry.MESH, stones=StoneCount.MANY, spectral=1, polarised=1),
    Features(
        Geometry.HULL, SURFACE["none"], SURFACE["none"], 0, SKY["constant"], dispersion=0, absorption=-1,
        fresnel=FRESNEL["exact"], camera_inside=0, stones=StoneCount.MANY,
    ),
]  # fmt: skip
"""Of several stones, which the chain estimator alone takes."""

WRONG = "__kernel void wrong(__global int *a) { *a = 1.5f; }"
"""An implicit conversion: the compiler must complain of it, or its silence about the kernels means nothing."""

Program = tuple[str, tuple[str, ...]]
"""A file's name, and the options to compile it with."""


def programs() -> list[Program]:
    """All that must compile; the longest first, so that all cores end together."""
    features = [
        replace(features, estimator=estimator)
        for features in (*(Features(geometry) for geometry in Geometry), *FIXED)
        for estimator in ESTIMATOR.values()
    ] + MANY
    renderers = [
        ("render.cl", (*variant.options, *each.options)) for variant, each in product(VARIANTS, features)
    ]  # a feature that is left to run time is no option
    rays = [
        ("path.cl", (*Variant(lanes=1, real=real).options, *each.options))
        for real, each in product((np.float32, np.float64), (*(Features(geometry) for geometry in Geometry), *MANY))
    ]
    alone = [
        (name, tuple(variant.options))
        for name in culet_kernels.NAMES
        for variant in (VARIANTS if "__kernel" in culet_kernels.written(name) else BY_ITSELF)
    ]
    return [*renderers, *rays, *alone]


@cache
def device() -> Device:
    """This process's."""
    return open_device()


def complaint(program: Program) -> str:
    """What the compiler says about one program; empty if it is content."""
    name, options = program
    words = _compiled(culet_kernels.source(name), options)
    return f"{name} with {' '.join(options)}: {words}" if words else ""


def _compiled(source: str, options: tuple[str, ...]) -> str:
    program = cl.Program(device().context, ALL_WARNINGS + source)
    try:
        program.build([*FLAGS, "-Werror", *options])
    except cl.Error as error:
        return str(error)
    return ""


def main() -> int:
    """Exit code 1 with the compiler's words if a file does not compile cleanly."""
    if "implicit conversion" not in _compiled(WRONG, ()):
        print("this compiler does not warn, so what it compiles proves nothing", file=sys.stderr)
        return 1
    wanted = programs()
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as compilers:
        complaints = [words for words in compilers.map(complaint, wanted, chunksize=4) if words]
    print(*complaints, sep="\n", file=sys.stderr, end="\n" if complaints else "")
    print(f"{len(wanted) - len(complaints)} of {len(wanted)} OpenCL programs compile without a warning")
    return min(len(complaints), 1)


if __name__ == "__main__":
    sys.exit(main())
