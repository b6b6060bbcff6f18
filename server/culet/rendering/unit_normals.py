"""Facets in the kernels' numbers, such that light between parallel ones keeps its angle.

A reflection at a normal of squared length 1 + e changes the cosine to it by a factor of 1 + 2 e. With each component
rounded to the nearest number of single precision e is up to 1e-7. In most stones that is lost among other rounding:
light takes some hundred reflections at many facets. Where every facet has a parallel one, as in a box, light that came
in at a grazing angle takes thousands of them at the same six facets; all push it the same way, past the critical
angle, and it stays for ever.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.rendering.device import Real

Array = NDArray[np.float64]
ABOUT = np.array(list(product(range(-3, 4), repeat=2)))
"""Numbers about the nearest that are tried for two of the components, in units in the last place."""
WEIGHT = 60
"""How much worse it is that a squared length is not 1 than that a component is not what it should be: lengths come out
within 2e-9 for most normals, and those turned by 1e-7, which is twice what rounding does."""


def planes_in(real: Real, planes: Array) -> NDArray[np.floating[Any]]:
    """(F, 4) planes of a convex stone, rounded; with normals of unit length if every facet has a parallel one."""
    rounded: NDArray[np.floating[Any]] = planes.astype(real)
    normals = planes[:, :3]
    if (normals @ normals.T).min(axis=1).max() < -1 + 1e-12:
        rounded[:, :3] = _of_unit_length(normals, real)
    return rounded


def _of_unit_length(normals: Array, real: Real) -> NDArray[np.floating[Any]]:
    """Opposite normals stay opposite, and components that are 0 stay so."""
    exact = np.abs(normals)[:, None]
    tried: NDArray[np.floating[Any]] = np.repeat(exact.astype(real), 3 * len(ABOUT), axis=1)
    step = np.spacing(tried)
    for solved in range(3):  # two components are about the nearest number, the third is what that leaves
        others, part = [k for k in range(3) if k != solved], slice(solved * len(ABOUT), (solved + 1) * len(ABOUT))
        tried[:, part, others] += (step[:, part, others] * ABOUT).astype(real)
        left = 1 - (tried[:, part, others].astype(np.float64) ** 2).sum(axis=2)
        tried[:, part, solved] = np.sqrt(np.maximum(left, 0))
    tried[np.broadcast_to(exact == 0, tried.shape)] = 0
    excess = np.abs((tried.astype(np.float64) ** 2).sum(axis=2) - 1)
    best = np.maximum(np.abs(tried - exact).max(axis=2), WEIGHT * excess).argmin(axis=1)
    chosen: NDArray[np.floating[Any]] = np.copysign(tried[np.arange(len(normals)), best], normals.astype(real))
    return chosen
