"""Stones whose facets reflect light into few directions only.

In most stones light turns into ever new directions, and soon into one that leaves. Where the reflections at all facets
make a finite group (Coxeter, Annals of Mathematics 35, 588 (1934)), as in a box or a prism of 60, 60, 60 degrees, light
that came in at a grazing angle comes back to the same few for thousands of reflections; each rounds its direction, and
what comes to be past the critical angle stays for ever. So for these the kernels reflect in double precision.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from culet.geometry.shape import Shape

MOST_MIRRORS = 32
"""Of a group that counts as finite: 15 are in an icosahedron's, m + 1 in that of a prism over a polygon of m sides."""
SAME = 1e-9
"""Cosines this near to 1 are of one direction."""


_ANSWERS: WeakKeyDictionary[Shape, bool] = WeakKeyDictionary()


def makes_finite_group(shape: Shape) -> bool:
    """Whether the facets as mirrors, and their images in each other, are at most MOST_MIRRORS; found out once."""
    if shape not in _ANSWERS:
        _ANSWERS[shape] = _are_few(shape)
    return _ANSWERS[shape]


def _are_few(shape: Shape) -> bool:
    mirrors, waiting = np.empty((0, 3)), shape.planes[:, :3]
    while len(waiting):
        for normal in waiting:
            if (np.abs(mirrors @ normal) < 1 - SAME).all():
                mirrors = np.vstack([mirrors, normal])
                if len(mirrors) > MOST_MIRRORS:
                    return False
        images = (mirrors[:, None] - 2 * (mirrors @ mirrors.T)[..., None] * mirrors).reshape(-1, 3)
        waiting = images[(np.abs(images @ mirrors.T) < 1 - SAME).all(axis=1)]
    return True
