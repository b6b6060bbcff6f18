"""Seconds to reach an error: culet, its classic estimator and Mitsuba 3, on the same stone, one after the other."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from culet.geometry.load import stone_of
from culet.scene.model import GradientEnvironment, Optics, Plane
from culet.study.cases import CHECKER
from culet.study.convergence import resting_error, time_to
from culet.study.frame import Frame, Studied
from culet.study.image_error import radiance_error
from culet.study.knobs import base_knobs
from culet.study.reference import Reference
from culet.study.renderers import Renderers
from culet.study.report import Figure, Point, Race

TARGETS = (0.02, 0.01, 0.005, 0.002)
"""RMSE in radiance, under a sky from 0 to 1."""
FIGURES: dict[str, Figure] = {
    "race_seconds": Figure(unit="s", about="Race: time in the renderer until then, compiled beforehand."),
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
    "culet, cut-off 0.05": Optics(cutoff=0.05),
    "classic estimator": Optics(estimator="classic", fresnel="schlick", max_bounces=12),
}


def race_frame(width: int, height: int) -> Frame:
    """The race's picture."""
    return Frame(Studied(RACE, stone_of(RACE.stones[0], {})), width, height)


def run_culet(name: str, renderers: Renderers, frame: Frame, reference: Reference, seconds: float) -> Iterator[Point]:
    """One sample of each pixel after the other, judged at every power of two, for at most `seconds`."""
    scene = frame.subject.scene.model_copy(update={"optics": ENTRANTS[name]})
    knobs = base_knobs(scene, frame.subject.stone, renderers.device.lanes)
    renderers.picture(knobs, frame).refine(1)  # compiles
    picture = renderers.picture(knobs, frame)
    taken, most = 0.0, max(reference.images) // 4  # the reference holds the same samples: it must have many more
    while taken < seconds and picture.samples < most:
        picture.refine(1)
        taken += picture.seconds
        if picture.samples.bit_count() == 1:
            rmse = radiance_error(picture.linear(), reference.image)["rmse"]
            yield _point(name, picture.samples, taken, rmse)


def run_mitsuba(frame: Frame, reference: NDArray[np.float64], spp: int, seconds: float) -> Iterator[Point]:
    """Passes of `spp` samples for at most `seconds` and a pass; nothing if it fails, see `mitsuba_missing`."""
    scene, stone, _ = frame.subject
    camera, material = scene.camera, scene.stones[0].material
    with tempfile.TemporaryDirectory() as folder:
        mesh, image = Path(folder) / "stone.ply", Path(folder) / "reference.npy"
        trimesh.Trimesh(stone.vertices, stone.triangles, process=False).export(mesh)
        np.save(image, reference)
        order = {
            "stone": str(mesh), "reference": str(image), "ior": list(getattr(material, "ior")), "spp": spp,  # noqa: B009
            "size": [frame.width, frame.height], "eye": camera.position, "target": camera.target,
            "fov": camera.fov_degrees, "seconds": seconds,
        }  # fmt: skip
        run = subprocess.run(
            [sys.executable, "-m", "culet.study.mitsuba"],
            input=json.dumps(order), capture_output=True, text=True, check=False,
        )  # fmt: skip
    passes = [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")]
    for number, found in enumerate(passes, 1):
        if number.bit_count() == 1 or number == len(passes):
            yield _point(f"Mitsuba 3, {found['variant']}", found["samples"], found["seconds"], found["rmse"])


def mitsuba_missing() -> bool:
    """Whether it is not installed."""
    return find_spec("mitsuba") is None


def results(points: Sequence[Point], targets: Sequence[float] = TARGETS) -> list[Race]:
    """Seconds to every target, of each renderer that took part."""
    races = []
    for name in dict.fromkeys(str(point.knobs["renderer"]) for point in points if point.group == "race"):
        own = [point for point in points if point.group == "race" and point.knobs["renderer"] == name]
        own.sort(key=lambda point: point.figures["race_seconds"] or 0.0)
        seconds = [point.figures["race_seconds"] or math.nan for point in own]
        errors = [point.figures["race_rmse"] or math.nan for point in own]
        floor = resting_error(seconds, errors)
        reached = {f"{target:g}": time_to(seconds, errors, target, floor=floor) for target in targets}
        races.append(
            Race(
                name=name,
                note="" if floor is None else f"biased: comes to rest at {floor:.3g}",
                seconds={target: reach.seconds for target, reach in reached.items()},
                extrapolated=tuple(target for target, reach in reached.items() if reach.extrapolated),
            )
        )
    return races


def _point(name: str, samples: int, seconds: float, rmse: float) -> Point:
    return Point(
        key=f"race {name} samples={samples}",
        group="race",
        label=f"{name}, {samples} samples",
        knobs={"renderer": name, "samples": samples},
        figures={"race_seconds": seconds, "race_rmse": rmse},
    )
