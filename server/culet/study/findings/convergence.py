"""Orders of convergence, and the time that an error takes, from measured points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

ROUNDING = 1e-11
"""An error below this is rounding's, which no smaller step takes away."""
COARSE = 0.3
"""An error above this (rad, R) is too large to be that of a small step."""


class OrderFit(NamedTuple):
    """error = exp(constant) x step^order."""

    order: float
    constant: float
    points: int


def fit_order(
    steps: Sequence[float], errors: Sequence[float], *, floor: float = ROUNDING, ceiling: float = COARSE
) -> OrderFit | None:
    """Least squares on the logarithms of those errors that lie between floor and ceiling; None below two of them."""
    used = np.log([(step, error) for step, error in zip(steps, errors, strict=True) if floor < error < ceiling])
    if len(used) < 2 or np.ptp(used[:, 0]) == 0:
        return None
    order, constant = np.polyfit(used[:, 0], used[:, 1], 1)
    return OrderFit(float(order), float(constant), len(used))


REST = -0.2
"""An error that falls more slowly than time to this power has come to rest; that of independent samples has -1/2."""


def resting_error(seconds: Sequence[float], errors: Sequence[float]) -> float | None:
    """The error at which a curve has come to rest at its end, a bias; None if it still falls."""
    if len(errors) < 3 or not errors[-1] > 0:
        return None
    slope = math.log(errors[-1] / errors[-2]) / math.log(seconds[-1] / seconds[-2])
    return errors[-1] if slope > REST else None


class TimeTo(NamedTuple):
    """Seconds until an error is reached."""

    seconds: float | None
    extrapolated: bool = False


def time_to(seconds: Sequence[float], errors: Sequence[float], target: float, *, floor: float | None = None) -> TimeTo:
    """When a curve of falling error first comes to `target`, between its points along a power law.

    Beyond its last point the curve goes on as 1 / sqrt(time), which is what independent samples do. Where the error has
    come to rest at `floor` (a bias), what is below is never reached.
    """
    previous: tuple[float, float] | None = None
    for time, error in zip(seconds, errors, strict=True):
        if error <= target:
            if previous is None or previous[1] <= error:
                return TimeTo(time)
            part = math.log(previous[1] / target) / math.log(previous[1] / error) if error > 0 else 1.0
            return TimeTo(previous[0] * (time / previous[0]) ** part)
        previous = time, error
    if previous is None or (floor is not None and target <= floor):
        return TimeTo(None)
    return TimeTo(previous[0] * (previous[1] / target) ** 2, extrapolated=True)
