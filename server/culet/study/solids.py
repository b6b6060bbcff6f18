"""Solids to try things on: the default cut, boxes, and what has the fewest facets or very many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.load import shape_of
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.scene.stone import StoneSettings


def brilliant() -> Shape:
    """The default cut."""
    return shape_of(StoneSettings(), {})


def scaled(factor: float) -> Callable[[], Shape]:
    """The brilliant from a file in other units."""

    def read() -> Shape:
        shape = brilliant()
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (factor * shape.vertices).tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (shape.triangles + 1).tolist()]
        return shape_from_mesh("\n".join(lines).encode(), "obj", name=f"brilliant x {factor:g}")

    return read


def box(x: float, y: float, z: float) -> Callable[[], Shape]:
    """By its sides."""
    planes = [[*(sign * np.eye(3)[axis]), side] for axis, side in enumerate((x, y, z)) for sign in (1, -1)]
    return lambda: shape_from_half_spaces("box", np.array(planes))


def tetrahedron() -> Shape:
    """Four facets: the fewest."""
    return shape_from_half_spaces(
        "tetrahedron", np.array([(1, 1, 1, 1), (1, -1, -1, 1), (-1, 1, -1, 1), (-1, -1, 1, 1.0)])
    )


def ball(facets: int) -> Callable[[], Shape]:
    """Tangent planes of a sphere, scattered evenly at random."""
    normals = np.random.default_rng(1).normal(size=(facets, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return lambda: shape_from_half_spaces("ball", np.column_stack([normals, np.ones(facets)]))
