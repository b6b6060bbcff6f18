"""Normals whose length is 1 in the kernels' numbers, where light comes back to the same directions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from culet.geometry.mesh import stone_from_mesh
from culet.geometry.stone import Stone
from culet.rendering.tree import rounded_corners, tree_of
from culet.rendering.unit_normals import makes_finite_group, rounded_normals
from culet.study.extremes import ball
from geometry.shapes import obj
from geometry.shapes import prism as extruded
from rendering.views import prism, slab
from validation.stones import brilliant, ring, skew_block, step_cut

L_SHAPE = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]) - 0.8

FINITE = {
    "box": slab(0.3),
    "60, 60, 60": prism(60),
    "45, 45, 90": prism(90),
    "40, 70, 70": prism(40),
    "L": stone_from_mesh(obj(*extruded(L_SHAPE, 0.7)), "obj", name="L"),
}
ENDLESS = {"brilliant": brilliant(), "step cut": step_cut(), "skew block": skew_block(), "ring": ring()}


@pytest.mark.parametrize("name", FINITE)
def test_of_stones_whose_mirrors_are_few_every_normal_has_unit_length(name: str) -> None:
    stone, random = FINITE[name], np.random.default_rng(0)
    assert makes_finite_group(stone)
    for _ in range(20):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        exact = stone.planes[:, :3] @ turn.T
        rounded = rounded_normals(np.float32, stone, exact).astype(float)
        assert abs((rounded**2).sum(axis=1) - 1).max() < 1e-8  # measured 6.0e-9; of the nearest numbers 8.0e-8
        assert abs(rounded - exact).max() < 5e-7  # measured 3.7e-7; of the nearest numbers 3.0e-8
        opposite = exact @ exact.T < -1 + 1e-12
        assert (rounded[np.nonzero(opposite)[0]] == -rounded[np.nonzero(opposite)[1]]).all()


@pytest.mark.parametrize("stone", [*ENDLESS.values(), ball(5000)()], ids=lambda stone: stone.name)
def test_other_stones_have_the_nearest_numbers(stone: Stone) -> None:
    normals = stone.planes[:, :3]
    assert not makes_finite_group(stone)
    assert (rounded_normals(np.float32, stone, normals) == normals.astype(np.float32)).all()


def test_triangles_have_the_same_normals_as_half_spaces() -> None:
    stone = prism(60)
    tree = tree_of(replace(stone, convex=False))
    normals = rounded_corners(tree, stone, np.float32)[:, 9:].transpose(0, 2, 1).reshape(-1, 3)
    of_planes = rounded_normals(np.float32, stone, stone.planes[:, :3])
    assert {tuple(n) for n in normals if n.any()} == {tuple(n) for n in of_planes}
