"""Converged pictures in double precision, which all others are judged against; made once and kept.

There are two for a scene. Both follow every chain down to CUTOFF, with exact Fresnel's formulas, in double precision,
over many samples. They differ in the light:

    model    as the scene has it: its bands (an index a channel, or wavelengths), polarisation averaged or carried
    physics  wavelengths sampled over the whole spectrum, polarisation carried: what a real stone would show

Against the first a knob shows its own error; against the second also that of the scene's idea of light.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_cache_path

from culet.rendering.film.doublings import RATE
from culet.rendering.opencl.device import Device
from culet.study.findings.provenance import REFERENCE_CODE, code_digest
from culet.study.renderer.knobs import Knobs
from culet.study.renderer.renderers import Renderers
from culet.study.renderer.shot import Shot

CUTOFF = 1e-5
"""Weight that a reference drops; what it loses is some hundredth of the least error that a study looks for."""
MAX_BOUNCES = 65536
PHYSICS_BANDS = 16
"""Wavelengths of a pixel's sample; they move from sample to sample, so that many samples see the whole spectrum."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class Reference:
    """A converged picture, and how it looked on the way there."""

    images: dict[int, NDArray[np.float64]]
    """(height, width, 3) linear radiance, by samples: 1, 2, 4 ... and the last, which is the reference."""
    error: float
    """Its own, as the last two doublings of its samples let expect: RMSE in radiance."""
    seconds: float
    """It took; 0 if it was kept from before."""

    @property
    def image(self) -> NDArray[np.float64]:
        """The converged one."""
        return self.images[self.samples]

    @property
    def samples(self) -> int:
        """Of each of its pixels."""
        return max(self.images)

    def after(self, samples: int) -> Reference:
        """Of all samples but the first ones, whose picture must be among `images`: shares none with a picture of those.

        It has nothing on the way, and the error that fewer samples have.
        """
        rest = self.samples - samples
        image = (self.samples * self.image - samples * self.images[samples]) / rest
        return Reference({rest: image}, self.error * (self.samples / rest) ** RATE, 0.0)


def reference_knobs(base: Knobs, kind: str, lanes: int) -> Knobs:
    """Settings of the reference `model` or `physics`."""
    exact = replace(
        base,
        estimator="chain", end="cut", cutoff=CUTOFF, max_bounces=MAX_BOUNCES, fresnel="exact",
        precision="double", lanes=lanes, scale=1.0, samples=1, relaxed_maths=True,
    )  # fmt: skip
    return exact if kind == "model" else replace(exact, bands=max(base.bands, PHYSICS_BANDS), polarised=True)


def make_reference(
    renderers: Renderers,
    shot: Shot,
    knobs: Knobs,
    samples: int,
    progress: Progress,
    *,
    steps: bool,
    cache: Path | None = None,
) -> Reference:
    """From the cache, or rendered. `steps` keeps the pictures on the way too. `cache`: a folder, the user's if None."""
    folder = cache or user_cache_path("culet") / "study"
    path = folder / f"{_digest(renderers.device, shot, knobs, samples, steps=steps)}.npz"
    if path.exists():
        with np.load(path) as kept:
            images = {int(name): kept[name] for name in kept.files if name != "error"}
            return Reference(images, float(kept["error"]), 0.0)
    start = time.perf_counter()
    picture = renderers.picture(knobs, shot)
    images = {}
    while picture.samples < samples:
        picture.refine(1)
        count = picture.samples
        if count == samples or (steps and count.bit_count() == 1):
            images[count] = picture.linear().astype(np.float64)
        progress(count / samples)
    reference = Reference(images, picture.error_estimate(), time.perf_counter() - start)
    _keep(path, {**{str(count): image for count, image in images.items()}, "error": np.array(reference.error)})
    return reference


def _digest(device: Device, shot: Shot, knobs: Knobs, samples: int, *, steps: bool) -> str:
    digest = hashlib.sha256()
    stage = shot.stage
    optics = knobs.applied_to(stage.scene).model_dump_json(exclude={"film", "simulation"})
    facts = (
        optics, knobs.key, shot.width, shot.height, samples, steps, device.name, device.driver,
        code_digest(REFERENCE_CODE),
    )  # fmt: skip
    digest.update(repr(facts).encode())
    surfaces = [array for shape in stage.shapes for array in (shape.vertices, shape.triangles)]
    for array in (*surfaces, *(() if stage.panorama is None else (stage.panorama,))):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:32]


def _keep(path: Path, arrays: dict[str, NDArray[Any]]) -> None:
    """Whole or not at all: another process may read at the same time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}.{os.getpid()}.npz")
    try:
        np.savez(part, allow_pickle=False, **arrays)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
