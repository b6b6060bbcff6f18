"""A measured number with what it may be off by."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Number:
    """Of one grade."""

    value: float
    error: float
    """Standard error, of the rays that were taken."""
    bound: float = 0.0
    """What the light of chains that were cut off could add at most."""


def ratio(part: NDArray[np.float64], whole: NDArray[np.float64], lost: NDArray[np.float64] | None = None) -> Number:
    """Part over whole, of sums over batches (B,) that were drawn apart, with the standard error of a ratio of means
    (Cochran, Sampling Techniques, 1977, 2.11). Of nothing it is 0."""
    total = float(whole.sum())
    if total <= 0:
        return Number(0.0, 0.0)
    value, count = float(part.sum()) / total, len(part)
    off = part - value * whole
    error = math.sqrt(float((off * off).sum()) * count / (count - 1)) / total if count > 1 else math.inf
    return Number(value, error, 0.0 if lost is None else float(lost.sum()) / total)
