"""Mitsuba 3 on the race's stone, in a process of its own: a wrong LLVM ends the process, not the study.

Its dielectric has no dispersion, so there is one render for each index, of which one channel is used. Order on standard
input, as JSON: stone (a .ply), ior, size, eye, target, fov, spp, seconds, reference (an .npy). Answer, a line for
each pass: {"variant", "seconds", "rmse", "samples"}. Compiling, and a first pass, are not counted.
"""

from __future__ import annotations

import json
import os
import re
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

VARIANTS = ("llvm_ad_mono", "llvm_ad_rgb", "scalar_rgb")
"""The first that runs is taken."""
LEAST_LLVM = 16
"""Older versions end the process."""
ENVIRONMENT_ROWS = 512
DEPTH = 256


def find_llvm() -> str | None:
    """The newest LLVM library that Dr.Jit can use; DRJIT_LIBLLVM_PATH decides if it is set."""
    if path := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return path
    found = [
        (int(version[1]), str(path))
        for folder in ("/usr/lib", "/usr/local/lib")
        for path in Path(folder).glob("**/libLLVM*.so*")
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
    scenes = [_scene(mi, order, index) for index in order["ior"]]
    reference = np.load(order["reference"])
    spp = order["spp"]
    for channel, scene in enumerate(scenes):
        np.array(mi.render(scene, spp=spp, seed=channel))  # compiles
    total, samples, seconds = np.zeros_like(reference), 0, 0.0
    while seconds < order["seconds"]:
        start = time.perf_counter()
        for channel, scene in enumerate(scenes):
            image = np.array(mi.render(scene, spp=spp, seed=3 + 3 * samples + channel))
            total[..., channel] += spp * image[..., min(channel, image.shape[-1] - 1)]
        seconds += time.perf_counter() - start
        samples += spp
        rmse = float(np.sqrt(np.mean((total / samples - reference) ** 2)))
        print(json.dumps({"variant": variant, "seconds": seconds, "rmse": rmse, "samples": samples}), flush=True)


def _scene(mi: Any, order: dict[str, Any], index: float) -> Any:  # noqa: ANN401 - without types
    width, height = order["size"]
    view = mi.ScalarTransform4f().look_at(origin=order["eye"], target=order["target"], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}}
    sensor = {"type": "perspective", "fov_axis": "y", "fov": order["fov"], "to_world": view, "film": film}
    bsdf = {"type": "dielectric", "int_ior": index, "ext_ior": 1.0}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": DEPTH},
            "sensor": {**sensor, "sampler": {"type": "independent"}},
            "sky": {"type": "envmap", "bitmap": mi.Bitmap(gradient_sky(ENVIRONMENT_ROWS))},
            "stone": {"type": "ply", "filename": order["stone"], "face_normals": True, "bsdf": bsdf},
        }
    )


if __name__ == "__main__":
    main()
