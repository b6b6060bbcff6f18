"""What the halves of a picture's samples tell of its error, whenever their number has doubled."""

from __future__ import annotations

import math

import numpy as np

RATE = 0.75
"""An edge through a pixel, sampled n times by well spread points, is known to n^-3/4 (D. Mitchell, Consequences of
stratified sampling in graphics, SIGGRAPH 1996): halfway between random samples and smooth pictures."""
MOST = 2**53
"""Samples, as many as nobody will take."""
LEVELS = 2
"""Doublings that an estimate is the mean of: a sequence is luckier with some numbers of samples than with others."""


class Doublings:
    """Root mean square errors of a picture of 2, 4, 8 ... samples, each as its two halves are apart.

    Any run of the sequence of samples is as well spread as another of its length, so the errors of the two halves are
    alike and as good as independent: half their difference is the error of their mean, whatever the rate of convergence
    is. That holds for the picture as it is shown too, where noise is small: a tone map is then nearly a straight line.
    """

    def __init__(self) -> None:
        """Without a sample."""
        self._errors: dict[int, float] = {}
        """By samples."""

    def clear(self) -> None:
        """As at first."""
        self._errors = {}

    def add(self, samples: int, squared: float, components: int) -> None:
        """There are so many samples now, whose halves' means differ by squares of that sum over all components."""
        self._errors[samples] = math.sqrt(squared / components) / 2

    def error(self, samples: int) -> float:
        """Of so many samples; NaN before the first doubling."""
        return self._of_one() / samples**RATE if self._errors else math.nan

    def samples_for(self, error: float) -> int | None:
        """How many samples let expect that error; None before the first doubling."""
        if not self._errors:
            return None
        ratio = self._of_one() / error
        return max(1, math.ceil(ratio ** (1 / RATE))) if ratio < MOST**RATE else MOST  # or it is no number

    def _of_one(self) -> float:
        """What the last LEVELS doublings say of a single sample, each taken on by RATE."""
        last = sorted(self._errors)[-LEVELS:]
        return float(np.sqrt(np.mean([(self._errors[count] * count**RATE) ** 2 for count in last])))
