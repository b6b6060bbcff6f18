"""Facets in the kernels' numbers, such that light that can only turn into few directions keeps its angles.

A reflection at a normal of squared length 1 + e changes the cosine to it by a factor of 1 + 2 e. With each component
rounded to the nearest number of single precision e is up to 1e-7. In most stones that is lost among other rounding:
light turns into ever new directions, and soon into one that leaves. Where the reflections at all facets make a finite
group (Coxeter, Annals of Mathematics 35, 588 (1934)), as in a box or a prism of 60, 60, 60 degrees, light that came in
at a grazing angle comes back to the same few for thousands of reflections; where all push it the same way, past the
critical angle, it stays for ever. What remains with normals of unit length is a random walk by the directions' own
rounding.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.geometry.stone import Stone
from culet.rendering.device import Real

Array = NDArray[np.float64]
ABOUT = np.array(list(product(range(-3, 4), repeat=2)))
"""Numbers about the nearest that are tried for two of the components, in units in the last place."""
WEIGHT = 60
"""How much worse it is that a squared length is not 1 than that a component is not what it should be: lengths come out
within 2e-9 for most normals, and those turned by 1e-7, a few times what rounding does. So other stones keep what
rounding makes of theirs: facets turned twice as far make twice as many pixels see another one."""
MOST_MIRRORS = 32
"""Of a group that counts as finite: 15 are in an icosahedron's, m + 1 in that of a prism over a polygon of m sides."""
SAME = 1e-9
"""Cosines this near to 1 are of one direction."""


def rounded_normals(real: Real, stone: Stone, normals: Array) -> NDArray[np.floating[Any]]:
    """(N, 3) unit normals of a stone's facets, in any order and turn, rounded; if it matters, to unit length."""
    return _of_unit_length(normals, real) if makes_finite_group(stone) else normals.astype(real)


@lru_cache(maxsize=16)
def makes_finite_group(stone: Stone) -> bool:
    """Whether the facets as mirrors, and their images in each other, are at most MOST_MIRRORS."""
    mirrors, waiting = np.empty((0, 3)), stone.planes[:, :3]
    while len(waiting):
        for normal in waiting:
            if (np.abs(mirrors @ normal) < 1 - SAME).all():
                mirrors = np.vstack([mirrors, normal])
                if len(mirrors) > MOST_MIRRORS:
                    return False
        images = (mirrors[:, None] - 2 * (mirrors @ mirrors.T)[..., None] * mirrors).reshape(-1, 3)
        waiting = images[(np.abs(images @ mirrors.T) < 1 - SAME).all(axis=1)]
    return True


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
