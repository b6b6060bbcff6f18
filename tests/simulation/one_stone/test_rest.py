"""Rest: on a stable facet, flat, without drift, asleep; and awake again when something happens."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from culet.errors import InputError
from culet.geometry.shape import Shape
from culet.simulation.one_stone.simulation import MAX_SPEED, Simulation
from culet.simulation.rigid_body.rotation import normalised, rotate_back
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS
from simulation.solids import TABLE_DOWN, UPRIGHT, about, advance, lowest, nearest, rigid, spin_of


def stable_normals(stone: Shape) -> NDArray[np.float64]:
    """(F, 3) outward normals of the facets on which a stone rests by itself: above which its centre of mass is.

    `compute_stable_poses` works on triangles and rounds normals to 3 decimals; it is asked for the set only.
    """
    mesh = trimesh.Trimesh(stone.vertices, stone.triangles, process=False)
    transforms, _ = trimesh.poses.compute_stable_poses(mesh, center_mass=np.zeros(3), threshold=1e-9)
    return np.asarray(-transforms[:, 2, :3], np.float64)  # the direction that the pose turns down


def dropped(stone: Shape, rng: np.random.Generator) -> Simulation:
    """From a random height, turned and spun at random, until it sleeps."""
    orientation = normalised(tuple(rng.normal(size=4).tolist()))
    height, spin = float(rng.uniform(0.5, 3)), tuple((4 * rng.normal(size=3)).tolist())
    moving = rigid(stone, (0.0, height, 0.0), orientation, spin=spin, rolling_resistance=0.01, time_step=1 / 60)
    while not moving.state.asleep and moving.state.time < 60:
        moving.step()
    return moving


def check_rest(moving: Simulation, stone: Shape, stable: NDArray[np.float64]) -> None:
    assert moving.state.asleep
    down = np.array(rotate_back(moving.state.orientation, (0.0, -1.0, 0.0)))
    facets = stone.planes[:, :3]
    tilt = np.linalg.norm(facets - down, axis=1).min()
    assert math.degrees(tilt) < 5e-3  # measured 7e-4 in 500 drops
    assert np.linalg.norm(stable - down, axis=1).min() < 1e-4, "a facet that carries the stone"  # measured 1.2e-5
    assert -1e-9 < nearest(moving) < 1e-5  # measured 0 to 9e-7
    assert spin_of(moving) == (0, 0, 0)


def test_a_dropped_brilliant_sleeps_on_a_stable_facet(brilliant: Shape) -> None:
    """Those of `validation/test_facet_frequencies.py` too."""
    stable, rng = stable_normals(brilliant), np.random.default_rng(12)
    for _ in range(12):
        check_rest(dropped(brilliant, rng), brilliant, stable)


def test_other_stones_sleep_on_a_stable_facet_too(box: Shape, double_cone: Shape) -> None:
    rng = np.random.default_rng(5)
    for stone in (box, double_cone):
        stable = stable_normals(stone)
        for _ in range(5):
            check_rest(dropped(stone, rng), stone, stable)


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.validation) for seed in range(2, 8))])
def test_a_stone_at_rest_that_may_not_sleep_does_not_move(brilliant: Shape, seed: int) -> None:
    """It does not move at all, so ten seconds show as much as a minute."""
    asleep = dropped(brilliant, np.random.default_rng(seed))
    start = asleep.state
    awake = rigid(brilliant, start.position, start.orientation, sleeping=False, rolling_resistance=0, time_step=1 / 60)
    path = advance(awake, 10)
    drift = max(math.dist(state.position, start.position) for state in path)
    turned = max(math.dist(state.orientation, start.orientation) for state in path)
    assert not path[-1].asleep
    assert drift < 1e-9  # measured 0, and of the turn
    assert turned < 1e-9


def test_a_stone_balanced_on_an_edge_does_not_sleep(box: Shape) -> None:
    """It may stand there, as a pencil may on its tip, but it is not at rest."""
    angle = math.atan2(3, 6)  # half edges 6/7 and 3/7: the diagonal is upright
    moving = rigid(box, (0.0, -1 + 3 / 7 * math.sqrt(5), 0.0), about((0.0, 0.0, 1.0), math.pi / 2 - angle))
    assert nearest(moving) == pytest.approx(0, abs=1e-9)
    advance(moving, 0.1)
    assert not moving.state.asleep


def test_asleep_only_time_passes(brilliant: Shape) -> None:
    moving = rigid(brilliant, (0.0, -1 + float(brilliant.vertices[:, 1].max()), 0.0), TABLE_DOWN)
    moving.step()
    first = moving.state
    assert first.asleep
    advance(moving, 1)
    assert (moving.state.position, moving.state.orientation) == (first.position, first.orientation)
    assert moving.state.time == pytest.approx(1 + 1 / 120)


def test_a_push_wakes_the_stone_and_gives_it_the_impulse(box: Shape) -> None:
    moving = rigid(box, (0.0, lowest(box), 0.0))
    resting = advance(moving, 0.1)[-1]
    assert resting.asleep
    at = resting.position
    moving.push((0.5, 0.0, 0.0), (at[0] - 6 / 7, at[1], at[2] + 0.1))
    pushed = moving.state
    assert not pushed.asleep
    assert pushed.momentum == (0.5, 0.0, 0.0)
    end = advance(moving, 3)[-1]
    assert end.asleep
    assert end.position[0] > 1e-3
    assert pushed.angular_momentum == pytest.approx((0, 0.05, 0), abs=1e-16)  # r x p


@pytest.mark.parametrize("impulse", [(math.nan, 0.0, 0.0), (0.0, math.inf, 0.0), (0.0, 0.0, 3 * MAX_SPEED)])
def test_a_push_that_makes_no_sense_is_refused(box: Shape, impulse: tuple[float, float, float]) -> None:
    moving = rigid(box, (0.0, lowest(box), 0.0))
    before = moving.state
    with pytest.raises(InputError, match="push"):
        moving.push(impulse, (0.0, 0.0, 0.0))
    assert moving.state is before


def test_walls_that_appear_wake_the_stone_and_put_it_inside(box: Shape) -> None:
    moving = rigid(box, (0.0, lowest(box), -12.0))
    advance(moving, 0.1)
    asleep = moving.state
    moving.surround((FLOOR, *WALLS))
    assert moving.state == replace(asleep, asleep=False)
    moving.step()
    assert nearest(moving) > -1e-9
    assert moving.state.momentum == pytest.approx((0, 0, 0), abs=1e-9)  # moved, not pushed


def test_the_same_walls_do_not_wake_it(box: Shape) -> None:
    moving = rigid(box, (0.0, lowest(box), 0.0))
    advance(moving, 0.1)
    moving.surround((FLOOR,))
    assert moving.settled


def test_walls_stop_a_stone_that_is_thrown_at_them(brilliant: Shape) -> None:
    moving = rigid(
        brilliant, (0.0, 2.0, 0.0), UPRIGHT, (FLOOR, *WALLS), velocity=(9, 2, -12), spin=(3, 1, 2),
        rolling_resistance=0.01,
    )  # fmt: skip
    while not moving.state.asleep and moving.state.time < 60:
        moving.step()
        assert nearest(moving) > -1e-5
    assert moving.state.asleep
