"""A stone of another shape lies, stands or floats where the one before it did."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from culet.geometry.load import shape_of
from culet.geometry.shape import Shape
from culet.scene import Scene, StoneSettings
from culet.scene.cuts import BrilliantCut
from culet.scene.fields import Pose
from culet.scene.room import FLOOR_Y
from culet.simulation import Simulation
from culet.simulation.lying import (
    LEVEL_DEGREES,
    LYING_DEGREES,
    laid,
    lowest_facet,
    on_the_floor,
    resting_facets,
    resting_height,
    slope_degrees,
)
from culet.simulation.rigid_body.rotation import rotate
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, Triple
from shared import stones

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


def cut(**proportions: float) -> Callable[[], Shape]:
    return lambda: shape_of(StoneSettings(cut=BrilliantCut(**proportions)), {})


CUTS = {"deep": cut(pavilion_degrees=46), "flat": cut(pavilion_degrees=37), "tall": cut(girdle_percent=9)}
OTHERS = {
    "step cut": stones.step_cut, "block": stones.skew_block, "tetrahedron": stones.tetrahedron, "ring": stones.ring,
}  # fmt: skip


DEFAULT = Scene().stones[0]


def at(position: Triple, orientation: Quaternion) -> StoneSettings:
    return DEFAULT.model_copy(update={"position": position, "orientation": orientation})


def lowest(pose: Pose, shape: Shape) -> float:
    """y of the lowest corner, R."""
    (_, y, _), orientation = pose
    return min(rotate(orientation, (a, b, c))[1] for a, b, c in shape.vertices.tolist()) + y


@pytest.mark.parametrize("name", CUTS)
def test_other_proportions_touch_the_floor_and_look_as_if_they_lay_there(name: str, brilliant: Shape) -> None:
    shape = CUTS[name]()
    position, orientation = pose = on_the_floor(DEFAULT, shape, DEFAULT, brilliant)
    assert lowest(pose, shape) == pytest.approx(FLOOR_Y, abs=1e-12)
    assert position[::2] == DEFAULT.position[::2]
    assert slope_degrees(orientation, lowest_facet(shape, orientation)) <= LYING_DEGREES


@pytest.mark.parametrize("name", [*OTHERS, "brilliant"])
def test_what_is_another_stone_lies_level(name: str, brilliant: Shape) -> None:
    shape = brilliant if name == "brilliant" else OTHERS[name]()
    stone = DEFAULT.model_copy(update={"mesh": "another"})
    position, orientation = pose = on_the_floor(stone, shape, DEFAULT, brilliant)
    assert lowest(pose, shape) == pytest.approx(FLOOR_Y, abs=1e-12)
    assert position[::2] == DEFAULT.position[::2]
    assert slope_degrees(orientation, lowest_facet(shape, orientation)) < LEVEL_DEGREES


def test_another_cut_lies_level_and_the_same_by_its_proportions_is_not_turned(brilliant: Shape) -> None:
    princess = DEFAULT.model_copy(update={"cut": "princess"})
    shape = shape_of(princess, {})
    _, orientation = on_the_floor(princess, shape, DEFAULT, brilliant)
    assert slope_degrees(orientation, lowest_facet(shape, orientation)) < LEVEL_DEGREES
    told = DEFAULT.model_copy(update={"cut": BrilliantCut(table_percent=60)})
    assert on_the_floor(told, shape_of(told, {}), DEFAULT, brilliant)[1] == DEFAULT.orientation
    mesh = DEFAULT.model_copy(update={"mesh": "a"})
    assert on_the_floor(mesh, shape_of(told, {}), mesh, brilliant)[1] == DEFAULT.orientation, "its angles are others"


def test_a_smaller_stone_lies_where_the_larger_one_did(brilliant: Shape) -> None:
    small = DEFAULT.model_copy(update={"scale": 0.5})
    (x, y, z), orientation = on_the_floor(small, brilliant, DEFAULT, brilliant)
    assert (x, z, orientation) == (*DEFAULT.position[::2], DEFAULT.orientation)
    assert y - FLOOR_Y == pytest.approx((DEFAULT.position[1] - FLOOR_Y) / 2, abs=1e-6)


@pytest.mark.parametrize("name", CUTS)
def test_another_brilliant_is_not_turned(name: str, brilliant: Shape) -> None:
    """Or it would jump under the slider."""
    _, orientation = on_the_floor(DEFAULT, CUTS[name](), DEFAULT, brilliant)
    assert orientation == DEFAULT.orientation


@pytest.mark.parametrize("name", OTHERS)
def test_what_is_laid_down_rests_there(name: str) -> None:
    stone, orientation = OTHERS[name](), DEFAULT.orientation
    orientation = laid(orientation, lowest_facet(stone, orientation))
    settings = SimulationSettings.of(Scene(), DEFAULT.model_copy(update={"spin": (0, 0, 0)}), stone)
    simulation = Simulation(settings, stone, (0.0, resting_height(stone, orientation), 0.0), orientation)
    start = simulation.state.position
    for _ in range(120):
        simulation.step()
    assert simulation.settled
    assert np.abs(np.subtract(simulation.state.position, start)).max() < 1e-6


def test_a_stone_that_was_set_on_its_culet_stays_upright(brilliant: Shape) -> None:
    standing = at((0.25, FLOOR_Y - float(brilliant.vertices[:, 1].min()), 0), UPRIGHT)
    shape = cut(pavilion_degrees=46)()
    _, orientation = pose = on_the_floor(standing, shape, standing, brilliant)
    assert orientation == UPRIGHT
    assert lowest(pose, shape) == pytest.approx(FLOOR_Y, abs=1e-12)


@pytest.mark.parametrize("height", [-1.2, 0.0, 3.0])
def test_a_stone_in_the_air_or_deep_in_the_floor_stays(brilliant: Shape, height: float) -> None:
    pose = (0.0, height, 0.0), DEFAULT.orientation
    assert on_the_floor(at(*pose), stones.skew_block(), at(*pose), brilliant) == pose


def test_a_body_lies_on_no_facet_that_its_weight_is_beside() -> None:
    """A column that leans 60 degrees tips over from its ends, and lies on its sides alone."""
    corners = np.array([(x + y * np.sqrt(3), y, z) for x in (-0.2, 0.2) for y in (-1, 1) for z in (-0.2, 0.2)])
    normals = resting_facets(corners)
    assert not (abs(normals[:, 1]) > 0.99).any()
    assert {tuple(row) for row in np.round(np.abs(normals), 3)} == {(0, 0, 1), (0.5, 0.866, 0)}
    assert len(np.unique(np.round(resting_facets(stones.skew_block().vertices), 6), axis=0)) == 6


@pytest.mark.parametrize("orientation", [UPRIGHT, DEFAULT.orientation])
def test_any_facet_can_be_laid_down(brilliant: Shape, orientation: Quaternion) -> None:
    for facet in ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8), lowest_facet(brilliant, orientation)):
        assert rotate(laid(orientation, facet), facet) == pytest.approx((0, -1, 0), abs=1e-12)
