"""What a sweep measures of each scene: the grades of its first stone, and of a picture how bright the stone is, how
wrong, and how long it took."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from culet.engine.session.outline import outline_of
from culet.engine.session.picking import placed
from culet.errors import InputError
from culet.grading.metrics import GRADES, measured
from culet.grading.optics import optics_of
from culet.grading.report import place_of
from culet.grading.rules import Rules
from culet.grading.sums import LightSums
from culet.rendering.opencl.device import open_device
from culet.stage import Stage
from culet.stills import render_stage

PICTURE = ("radiance", "error", "seconds")
"""Mean radiance of the stone's pixels, all channels; the picture's estimated root mean square error of radiance; s of
rendering."""
METRICS = (*GRADES, *PICTURE)


@dataclass(frozen=True)
class MetricEffort:
    """How well each scene is measured."""

    rules: Rules = field(default_factory=Rules)
    grade_error: float = 0.1
    """Points: twice the standard error of ISO."""
    stone: str | None = None
    """Its id; without one the first."""
    coloured: bool = False
    width: int = 320
    height: int = 180
    samples: int = 16


def check_metrics(names: Sequence[str]) -> None:
    """InputError for a name that none has, or that is given twice."""
    for name in names:
        if name not in METRICS:
            raise InputError(f"metric: expected one of {', '.join(METRICS)}; got {name!r:.40}", "metric")
        if names.count(name) > 1:
            raise InputError(f"metric: expected each once, got {name} more than once", "metric")


def columns_of(names: Sequence[str]) -> list[str]:
    """Of a table: each metric, and beside a grade its standard error."""
    return [column for name in names for column in ((name, f"{name}_error") if name in GRADES else (name,))]


def measure(sums: LightSums | None, stage: Stage, names: Sequence[str], effort: MetricEffort) -> dict[str, float]:
    """Those metrics of a stage, by `columns_of`; `sums` may be missing if none is a grade. InputError says why there
    are none, as of a stone that is not convex."""
    found: dict[str, float] = {}
    grades = frozenset(names) & frozenset(GRADES)
    if grades:
        assert sums is not None  # noqa: S101 - as said above
        place = place_of(stage, effort.stone)
        optics = optics_of(stage.scene.stones[place], stage.scene.millimetres, coloured=effort.coloured)
        for name, number in measured(
            sums, stage.shapes[place], optics, effort.rules, grades, effort.grade_error
        ).items():
            found |= {name: number.value, f"{name}_error": number.error}
    if set(names) & set(PICTURE):
        picture = render_stage(stage, effort.width, effort.height, samples=effort.samples)
        mask = outline_mask(stage, effort.stone, effort.width, effort.height)
        stone = picture.linear[mask][:, :3]
        found["radiance"] = float(stone.mean(dtype=np.float64)) if len(stone) else float("nan")
        found |= {"error": picture.missed.error, "seconds": picture.cost.seconds}
    return {column: found[column] for column in columns_of(names)}


@functools.cache
def light_sums() -> LightSums:
    """The process's own, made by the first grade."""
    return LightSums(open_device())


def outline_mask(stage: Stage, stone: str | None, width: int, height: int) -> NDArray[np.bool_]:
    """(height, width): the pixels whose centres are within a stone's outline, whatever stands before it; of a stone
    that is not convex, its hull's."""
    outline = np.array(outline_of(stage.scene.camera, placed(stage)[place_of(stage, stone)]))
    if not len(outline):
        return np.zeros((height, width), bool)
    x = (np.arange(width) + 0.5 - width / 2) / (height / 2)
    y = (height / 2 - np.arange(height) - 0.5) / (height / 2)
    start, way = outline, np.roll(outline, -1, axis=0) - outline
    sides = way[:, 0, None, None] * (y[None, :, None] - start[:, 1, None, None]) - way[:, 1, None, None] * (
        x[None, None, :] - start[:, 0, None, None]
    )
    inside: NDArray[np.bool_] = (sides >= 0).all(axis=0)
    return inside
