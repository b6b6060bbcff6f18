"""A stone of another shape lies, stands or floats where the one before it did."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from culet.geometry.load import stone_of
from culet.geometry.stone import Stone
from culet.scene import Scene, StoneSettings
from culet.scene.model import BrilliantCut
from culet.scene.room import FLOOR_Y
from culet.simulation import Simulation
from culet.simulation.lying import (
    LYING_DEGREES,
    laid,
    lowest_facet,
    on_the_floor,
    resting_facets,
    resting_height,
    slope_degrees,
)
from culet.simulation.rotation import rotate
from culet.simulation.state import Quaternion
from shared import stones

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


def cut(**proportions: float) -> Callable[[], Stone]:
    return lambda: stone_of(StoneSettings(cut=BrilliantCut(**proportions)), {})


CUTS = {"deep": cut(pavilion_degrees=46), "flat": cut(pavilion_degrees=37), "tall": cut(girdle_percent=9)}
OTHERS = {
    "step cut": stones.step_cut, "block": stones.skew_block, "tetrahedron": stones.tetrahedron, "ring": stones.ring,
}  # fmt: skip


def lowest(scene: Scene, stone: Stone) -> float:
    """y of the lowest corner, R."""
    placed = scene.stones[0]
    return min(rotate(placed.orientation, (a, b, c))[1] for a, b, c in stone.vertices.tolist()) + placed.position[1]


@pytest.mark.parametrize("name", [*CUTS, *OTHERS])
def test_another_shape_touches_the_floor_and_looks_as_if_it_lay_there(name: str, brilliant: Stone) -> None:
    stone = (CUTS | OTHERS)[name]()
    scene = on_the_floor(Scene(), stone, brilliant)
    placed, default = scene.stones[0], Scene().stones[0]
    assert lowest(scene, stone) == pytest.approx(FLOOR_Y, abs=1e-12)
    assert placed.position[::2] == default.position[::2]
    assert slope_degrees(placed.orientation, lowest_facet(stone, placed.orientation)) <= LYING_DEGREES


@pytest.mark.parametrize("name", CUTS)
def test_another_brilliant_is_not_turned(name: str, brilliant: Stone) -> None:
    """Or it would jump under the slider."""
    assert on_the_floor(Scene(), CUTS[name](), brilliant).stones[0].orientation == Scene().stones[0].orientation


@pytest.mark.parametrize("name", OTHERS)
def test_what_is_laid_down_rests_there(name: str) -> None:
    stone, orientation = OTHERS[name](), Scene().stones[0].orientation
    orientation = laid(orientation, lowest_facet(stone, orientation))
    settings = Scene().simulation.model_copy(update={"spin": (0, 0, 0)})
    simulation = Simulation(settings, stone, (0.0, resting_height(stone, orientation), 0.0), orientation)
    start = simulation.state.position
    for _ in range(120):
        simulation.step()
    assert simulation.settled
    assert np.abs(np.subtract(simulation.state.position, start)).max() < 1e-6


def test_a_stone_that_was_set_on_its_culet_stays_upright(brilliant: Stone) -> None:
    standing = Scene().moved((0.25, FLOOR_Y - float(brilliant.vertices[:, 1].min()), 0), UPRIGHT)
    stone = cut(pavilion_degrees=46)()
    scene = on_the_floor(standing, stone, brilliant)
    assert scene.stones[0].orientation == UPRIGHT
    assert lowest(scene, stone) == pytest.approx(FLOOR_Y, abs=1e-12)


@pytest.mark.parametrize("height", [-1.2, 0.0, 3.0])
def test_a_stone_in_the_air_or_deep_in_the_floor_stays(brilliant: Stone, height: float) -> None:
    scene = Scene().moved((0, height, 0), Scene().stones[0].orientation)
    assert on_the_floor(scene, stones.skew_block(), brilliant) == scene


def test_a_body_lies_on_no_facet_that_its_weight_is_beside() -> None:
    """A column that leans 60 degrees tips over from its ends, and lies on its sides alone."""
    corners = np.array([(x + y * np.sqrt(3), y, z) for x in (-0.2, 0.2) for y in (-1, 1) for z in (-0.2, 0.2)])
    normals = resting_facets(corners)
    assert not (abs(normals[:, 1]) > 0.99).any()
    assert {tuple(row) for row in np.round(np.abs(normals), 3)} == {(0, 0, 1), (0.5, 0.866, 0)}
    assert len(np.unique(np.round(resting_facets(stones.skew_block().vertices), 6), axis=0)) == 6


@pytest.mark.parametrize("orientation", [UPRIGHT, Scene().stones[0].orientation])
def test_any_facet_can_be_laid_down(brilliant: Stone, orientation: Quaternion) -> None:
    for facet in ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8), lowest_facet(brilliant, orientation)):
        assert rotate(laid(orientation, facet), facet) == pytest.approx((0, -1, 0), abs=1e-12)
