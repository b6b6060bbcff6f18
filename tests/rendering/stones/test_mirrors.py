"""Stones that reflect light into few directions: which they are, and that nothing is compiled into other programs."""

from __future__ import annotations

import numpy as np
import pytest

from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.rendering.features import features_of
from culet.rendering.stones.mirrors import makes_finite_group
from culet.scene.legacy import LEGACY_DEFAULT
from geometry.shapes import obj
from geometry.shapes import prism as extruded
from shared.stages import staged
from shared.stones import ball, brilliant, prism, ring, skew_block, slab, step_cut

L_SHAPE = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]) - 0.8

FINITE = {
    "box": slab(0.3),
    "60, 60, 60": prism(60),
    "45, 45, 90": prism(90),
    "40, 70, 70": prism(40),
    "L": shape_from_mesh(obj(*extruded(L_SHAPE, 0.7)), "obj", name="L"),
}
ENDLESS = [brilliant(), step_cut(), skew_block(), ring(), ball(5000)()]


@pytest.mark.parametrize("stone", FINITE.values(), ids=FINITE.keys())
def test_of_boxes_and_prisms_the_mirrors_are_few(stone: Shape) -> None:
    assert makes_finite_group(stone)
    assert features_of(staged(LEGACY_DEFAULT, stone)).few_mirrors == 1


@pytest.mark.parametrize("stone", ENDLESS, ids=lambda stone: stone.name)
def test_other_stones_have_no_end_of_mirrors(stone: Shape) -> None:
    assert not makes_finite_group(stone)
    assert features_of(staged(LEGACY_DEFAULT, stone)).few_mirrors == 0
