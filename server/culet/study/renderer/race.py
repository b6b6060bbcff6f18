"""Seconds to reach an error: culet, its classic estimator and Mitsuba 3, on the same stone, one after the other."""

from __future__ import annotations

import json
import math
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from culet.scene.optics import Optics
from culet.scene.room import Plane
from culet.scene.sky import GradientEnvironment
from culet.stage import Stage
from culet.study.bench.cases import CHECKER
from culet.study.findings.convergence import resting_error, time_to
from culet.study.likeness.radiance_error import radiance_error
from culet.study.renderer.knobs import base_knobs
from culet.study.renderer.mitsuba import LEAST_LLVM, SAMPLERS
from culet.study.renderer.renderers import Renderers
from culet.study.renderer.shot import Shot
from culet.study.report import Figure, Point, Race

TARGETS = (0.02, 0.01, 0.005, 0.002)
"""RMSE in radiance, under a sky from 0 to 1."""
FIGURES: dict[str, Figure] = {
    "race_seconds": Figure(unit="s", about="Race: time in the renderer until then, compiled beforehand."),
    "race_processor_seconds": Figure(unit="s", about="Race: the same of all cores together, whatever else they did."),
    "race_rmse": Figure(unit="radiance", about="Race: RMSE against the race's own reference."),
}
RACE = CHECKER.model_copy(
    update={
        "floor": Plane(kind="none"),
        "environment": GradientEnvironment(kind="gradient", bottom=(0, 0, 0), top=(1, 1, 1)),
        "optics": Optics(),
    }
)
"""A brilliant of three indices alone under the gradient sky: what every renderer can do."""
ENTRANTS = {
    "culet": Optics(),
    "culet, cut-off 0.02": Optics(cutoff=0.02),
    "culet, cut-off 0.05": Optics(cutoff=0.05),
    "classic estimator": Optics(estimator="classic", fresnel="schlick", max_bounces=12),
}
TURNS = 3
"""Pictures of culet's."""
PATIENCE = 300.0
"""s for Mitsuba to compile, besides LENGTHENED times what it is to render."""
LENGTHENED = 20
"""The spread sampler renders everything twice, each time twice as long as before; a busy machine does the rest."""
NO_LLVM = (
    f"No libLLVM of version {LEAST_LLVM} or newer was found, so that Mitsuba 3 renders by a scalar variant, which is "
    "slower: apt-get install libllvm19, or name the library by DRJIT_LIBLLVM_PATH."
)


def race_shot(width: int, height: int) -> Shot:
    """The race's picture."""
    return Shot(Stage.of(RACE), width, height)


def run_culet(
    name: str, renderers: Renderers, shot: Shot, reference: NDArray[np.float64], most: int, seconds: float
) -> Iterator[Point]:
    """At most `most` samples of each pixel, one after the other, judged at every power of two, for at most `seconds`.

    Several pictures take turns, and the median of their times counts: the whole run is so short that anything else on
    the machine would be seen in it.
    """
    scene = shot.stage.scene.model_copy(update={"optics": ENTRANTS[name]})
    knobs = base_knobs(shot.stage.showing(scene), renderers.device.lanes)
    renderers.picture(knobs, shot).refine(1)  # compiles
    pictures = [renderers.picture(knobs, shot) for _ in range(TURNS)]
    taken = processor = 0.0
    while TURNS * taken < seconds and pictures[0].samples < most:
        before = time.process_time()
        for picture in pictures:
            picture.refine(1)
        processor += (time.process_time() - before) / TURNS
        taken += statistics.median(picture.seconds for picture in pictures)
        if pictures[0].samples.bit_count() == 1:
            rmse = radiance_error(pictures[0].linear(), reference)["rmse"]
            yield _point(name, pictures[0].samples, taken, processor, rmse)


def run_mitsuba(
    shot: Shot,
    reference: NDArray[np.float64],
    spp: int,
    seconds: float,
    samplers: Sequence[str] = SAMPLERS,
    command: Sequence[str] = (sys.executable, "-m", "culet.study.renderer.mitsuba"),
) -> tuple[list[list[Point]], str]:
    """For some `seconds` with each of these samplers, beginning with `spp` samples.

    Returns the points of each sampler that came to its end, and what went wrong with the others.
    """
    scene, (shape,) = shot.stage.scene, shot.stage.shapes
    camera, material = scene.camera, scene.stones[0].material
    with tempfile.TemporaryDirectory() as folder:
        mesh, image = Path(folder) / "stone.ply", Path(folder) / "reference.npy"
        trimesh.Trimesh(shape.vertices, shape.triangles, process=False).export(mesh)
        np.save(image, reference)
        order = {
            "stone": str(mesh), "reference": str(image), "ior": list(getattr(material, "ior")), "spp": spp,  # noqa: B009
            "size": [shot.width, shot.height], "eye": camera.position, "target": camera.target,
            "fov": camera.fov_degrees, "seconds": seconds, "samplers": list(samplers),
        }  # fmt: skip
        output, problem = _told(command, json.dumps(order), PATIENCE + LENGTHENED * seconds)
    answers = [json.loads(line) for line in output.splitlines() if line.startswith("{")]
    ended = [found["ended"] for found in answers if "ended" in found]
    runs = [
        [
            _point(
                mitsuba_name(sampler), found["samples"], found["seconds"], found["processor_seconds"], found["rmse"],
                variant=found["variant"],
            )
            for found in answers
            if found.get("sampler") == sampler
        ]
        for sampler in ended
    ]  # fmt: skip
    missing = [mitsuba_name(sampler) for sampler in samplers if sampler not in ended]
    if missing:
        return runs, f"{' and '.join(missing)}: no whole run, and so no part in the race: {problem}"
    return runs, ""


def _told(command: Sequence[str], order: str, seconds: float) -> tuple[str, str]:
    """What a process prints when it is given that order, and its last words if it fails, or takes longer."""
    try:
        run = subprocess.run(  # noqa: S603 - this very interpreter
            command, input=order.encode(), capture_output=True, check=False, timeout=seconds
        )
    except subprocess.TimeoutExpired as error:
        return (error.stdout or b"").decode(), f"not done after {seconds:g} s"
    words = run.stderr.decode(errors="replace").strip() or f"exit code {run.returncode}"
    return run.stdout.decode(), words.splitlines()[-1]


def mitsuba_name(sampler: str) -> str:
    """As an entrant."""
    return f"Mitsuba 3, {sampler}"


def mitsuba_missing() -> bool:
    """Whether it is not installed."""
    return find_spec("mitsuba") is None


def results(points: Sequence[Point], targets: Sequence[float] = TARGETS, cost: str = "race_seconds") -> list[Race]:
    """Seconds to every target, of each renderer that took part."""
    races = []
    for name in dict.fromkeys(str(point.knobs["renderer"]) for point in points if point.group == "race"):
        own = [point for point in points if point.group == "race" and point.knobs["renderer"] == name]
        own.sort(key=lambda point: point.figures.get(cost) or 0.0)
        seconds = [point.figures.get(cost) or math.nan for point in own]
        errors = [point.figures["race_rmse"] or math.nan for point in own]
        floor = resting_error(seconds, errors)
        reached = {f"{target:g}": time_to(seconds, errors, target, floor=floor) for target in targets}
        races.append(
            Race(
                name=name,
                note=str(own[0].knobs.get("variant", "")) if floor is None else f"biased: comes to rest at {floor:.3g}",
                seconds={target: reach.seconds for target, reach in reached.items()},
                extrapolated=tuple(target for target, reach in reached.items() if reach.extrapolated),
            )
        )
    return races


def _point(name: str, samples: int, seconds: float, processor: float, rmse: float, **knobs: str) -> Point:
    return Point(
        key=f"race {name} samples={samples}",
        group="race",
        label=f"{name}, {samples} samples",
        knobs={"renderer": name, "samples": samples, **knobs},
        figures={"race_seconds": seconds, "race_processor_seconds": processor, "race_rmse": rmse},
    )
