"""Mitsuba 3 on the race's stone, in a process of its own: a wrong LLVM ends the process, not the study.

Its dielectric has no dispersion, so there is one render for each index, of which one channel is used. Order on standard
input, as JSON: stone (a .ply), ior, size, eye, target, fov, spp, seconds, samplers, reference (an .npy). Answer, a line
for each error, {"variant", "sampler", "samples", "seconds", "processor_seconds", "rmse"}, and {"ended": sampler} when a
sampler is through. Compiling, and a first render, are not counted.

It takes part twice: with its usual sampler, independent, pass after pass; and with the best of its others for this
picture, multijitter (of 5, by time to an RMSE of 0.005), which spreads the samples of one render, so that each number
of samples is a render of its own; it takes some more than it is told where they fill no grid (35 for 32).
"""

from __future__ import annotations

import json
import os
import re
import sys
import time
from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

VARIANTS = ("llvm_ad_mono", "llvm_ad_rgb", "scalar_rgb")
"""The first that runs is taken."""
LEAST_LLVM = 16
"""Older versions end the process."""
INDEPENDENT, SPREAD = SAMPLERS = "independent", "multijitter"
ENVIRONMENT_ROWS = 512
"""Of the sky's panorama; between them it is off by (pi / 512)^2 / 16 = 2e-6 of radiance."""
DEPTH = 256
"""Segments of a path at most, as many as culet's `max_bounces`: few are that long."""


def find_llvm(roots: Iterable[Path] = (Path("/usr/lib"), Path("/usr/local/lib"))) -> str | None:
    """The newest LLVM library that Dr.Jit can use, where Debian puts them; DRJIT_LIBLLVM_PATH decides if it is set."""
    if path := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return path
    found = [
        (int(version[1]), str(path))
        for root in roots
        for pattern in ("libLLVM*.so*", "*/libLLVM*.so*", "llvm-*/lib/libLLVM*.so*")
        for path in root.glob(pattern)
        if (version := re.search(r"libLLVM(?:\.so\.|-)(\d+)", path.name))
    ]
    usable = [entry for entry in found if entry[0] >= LEAST_LLVM]
    return max(usable)[1] if usable else None


def gradient_sky(rows: int) -> Any:  # noqa: ANN401
    """(rows, 2 rows, 3) panorama, black below, white above, linear in the direction's y."""
    theta = (np.arange(rows) + 0.5) / rows * np.pi
    grey = 0.5 * (1 + np.cos(theta)).astype(np.float32)
    return np.broadcast_to(grey[:, None, None], (rows, 2 * rows, 3)).copy()


def main() -> None:
    """Entry of that process."""
    order = json.load(sys.stdin)
    mi: Any = import_module("mitsuba")

    llvm = find_llvm()
    if llvm is not None:
        os.environ["DRJIT_LIBLLVM_PATH"] = llvm
    variant = next(v for v in VARIANTS if v in mi.variants() and (llvm is not None or not v.startswith("llvm")))
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)  # warnings would go between the answers
    reference = np.load(order["reference"])
    for sampler in order["samplers"]:
        run = {INDEPENDENT: _passes, SPREAD: _doublings}[sampler]
        scenes = [_scene(mi, order, index, sampler) for index in order["ior"]]
        for taken, image, samples in run(mi, scenes, order["spp"], order["seconds"]):
            rmse = float(np.sqrt(np.mean((image - reference) ** 2)))
            answer = {"variant": variant, "sampler": sampler, "samples": samples, **taken._asdict(), "rmse": rmse}
            print(json.dumps(answer), flush=True)
        print(json.dumps({"ended": sampler}), flush=True)


class Taken(NamedTuple):
    """Time, on the wall and of all cores together."""

    seconds: float
    processor_seconds: float


Rendered = Iterator[tuple[Taken, Any, int]]
"""Time, (height, width, 3) image, samples."""


def _passes(mi: Any, scenes: list[Any], spp: int, most: float) -> Rendered:  # noqa: ANN401
    """The mean of more and more passes, at every power of two."""
    _render(mi, scenes, spp, 0)  # compiles
    total, samples, taken = 0.0, 0, Taken(0.0, 0.0)
    while taken.seconds < most:
        image, own = _render(mi, scenes, spp, 1 + samples)
        total = total + spp * image
        samples += spp
        taken = Taken(taken.seconds + own.seconds, taken.processor_seconds + own.processor_seconds)
        if (samples // spp).bit_count() == 1:
            yield taken, total / samples, samples


def _doublings(mi: Any, scenes: list[Any], spp: int, most: float) -> Rendered:  # noqa: ANN401
    """Single renders of twice as many samples each."""
    taken = Taken(0.0, 0.0)
    while taken.seconds < most / 2:  # the next takes twice as long
        _render(mi, scenes, spp, 0)  # compiles
        image, taken = _render(mi, scenes, spp, 1)
        sampler = scenes[0].sensors()[0].sampler().clone()
        sampler.set_sample_count(spp)
        yield taken, image, sampler.sample_count()
        spp *= 2


def _render(mi: Any, scenes: list[Any], spp: int, seed: int) -> tuple[Any, Taken]:  # noqa: ANN401
    """One channel of each scene's picture, and what that took."""
    wall, processor = time.perf_counter(), time.process_time()
    images = [np.array(mi.render(scene, spp=spp, seed=3 * seed + k)) for k, scene in enumerate(scenes)]
    image = np.stack([image[..., min(k, image.shape[-1] - 1)] for k, image in enumerate(images)], axis=-1)
    return image, Taken(time.perf_counter() - wall, time.process_time() - processor)


def _scene(mi: Any, order: dict[str, Any], index: float, sampler: str) -> Any:  # noqa: ANN401 - without types
    width, height = order["size"]
    view = mi.ScalarTransform4f().look_at(origin=order["eye"], target=order["target"], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}}
    sensor = {"type": "perspective", "fov_axis": "y", "fov": order["fov"], "to_world": view, "film": film}
    bsdf = {"type": "dielectric", "int_ior": index, "ext_ior": 1.0}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": DEPTH},
            "sensor": {**sensor, "sampler": {"type": sampler}},
            "sky": {"type": "envmap", "bitmap": mi.Bitmap(gradient_sky(ENVIRONMENT_ROWS))},
            "stone": {"type": "ply", "filename": order["stone"], "face_normals": True, "bsdf": bsdf},
        }
    )


if __name__ == "__main__":
    main()
