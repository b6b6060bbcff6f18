"""What the picture of a setting misses, as `python -m culet.study.serving.ladder` has measured it over a grid."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Grid = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class SettingErrors:
    """Root mean square errors of the legacy default scene at 1280x720, one sample a pixel, brought to that size.

    Between the settings measured they are interpolated: linearly by scale, by the logarithm of the other two.
    """

    scales: tuple[float, ...]
    """Of width and height. Scales, cut-offs and bounces are ascending."""
    cutoffs: tuple[float, ...]
    max_bounces: tuple[int, ...]
    shown_errors: Grid
    """(scales, cutoffs, max_bounces), of what is shown, 0 to 1."""
    radiance_errors: Grid
    """(scales, cutoffs, max_bounces), of the linear radiance."""

    def shown(self, scale: float, cutoff: float, max_bounces: int) -> float:
        """NaN beyond the settings that were measured."""
        return _interpolated(self, "shown", scale, cutoff, max_bounces)

    def radiance(self, scale: float, cutoff: float, max_bounces: int) -> float:
        """NaN beyond the settings that were measured."""
        return _interpolated(self, "radiance", scale, cutoff, max_bounces)


@lru_cache(maxsize=256)
def _interpolated(
    measured: SettingErrors, kind: Literal["shown", "radiance"], scale: float, cutoff: float, max_bounces: int
) -> float:
    """NaN beyond the settings that were measured. Settings come again, frame by frame."""
    errors = measured.shown_errors if kind == "shown" else measured.radiance_errors
    axes = np.array(measured.scales), np.log(measured.cutoffs), np.log(measured.max_bounces)
    for axis, place in zip(axes, (scale, np.log(cutoff), np.log(max_bounces)), strict=True):
        if not axis[0] <= place <= axis[-1]:
            return math.nan
        upper = max(1, int(np.searchsorted(axis, place)))
        weight = (place - axis[upper - 1]) / (axis[upper] - axis[upper - 1])
        errors = (1 - weight) * errors[upper - 1] + weight * errors[upper]
    return float(errors)


def read_setting_errors() -> SettingErrors:
    """As measured."""
    errors = json.loads(files(__package__).joinpath("ladder.json").read_text(encoding="utf-8"))["errors"]
    return SettingErrors(
        scales=tuple(errors["scales"]),
        cutoffs=tuple(errors["cutoffs"]),
        max_bounces=tuple(errors["max_bounces"]),
        shown_errors=np.array(errors["shown"]),
        radiance_errors=np.array(errors["radiance"]),
    )
