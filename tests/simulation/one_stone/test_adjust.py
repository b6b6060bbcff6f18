"""Settings that change while the stone moves: it goes on from where it is, reproducibly, and wakes if that moves it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from culet.errors import SolverUnavailableError
from culet.geometry.shape import Shape
from culet.simulation.one_stone.models import MODELS
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.state import RigidState
from culet.simulation.rigid_body.surfaces import FLOOR, WALLS
from simulation.solids import TILTED, advance, classic, lowest, nearest, rigid

CHANGES: dict[str, dict[str, Any]] = {
    "restitution": {"restitution": 0.1},
    "friction": {"friction": 0.9},
    "gravity": {"gravity": 3},
    "rolling resistance": {"rolling_resistance": 0.05},
    "integrator": {"integrator": "midpoint"},
    "time step": {"time_step": 1 / 60},
    "contact step": {"contact_step": 0.005},
    "mass": {"mass": 7},
    "inertia": {"inertia": "cone"},
    "model": {"model": "classic"},
}


def adjusted(moving: Simulation, **changes: object) -> Simulation:
    moving.adjust(moving.settings.model_validate(moving.settings.model_dump() | changes))
    return moving


def falling(box: Shape) -> Simulation:
    return rigid(box, (0.0, 1.0, 0.0), TILTED, spin=(1, 2, 3), velocity=(1, 0, 0))


def asleep(box: Shape) -> Simulation:
    moving = rigid(box, (0.0, lowest(box), 0.0))
    moving.step()
    assert moving.state.asleep
    return moving


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_keeps_pose_and_velocities_and_alters_what_follows(box: Shape, name: str) -> None:
    whole, other = falling(box), falling(box)
    advance(whole, 0.3)
    advance(other, 0.3)
    before = other.body, other.state
    adjusted(other, **CHANGES[name])
    assert other.interpolated(1) == whole.interpolated(1)
    assert other.body.velocity(other.state) == pytest.approx(before[0].velocity(before[1]), rel=1e-15, abs=0)
    omega = before[0].angular_velocity(before[1])
    assert other.body.angular_velocity(other.state) == pytest.approx(omega, rel=1e-13, abs=0)  # measured 7e-15
    for moving in (whole, other):
        while moving.state.time < 2:
            moving.step()
    same = name == "mass"  # all stones fall, bounce and slide alike
    assert (other.state.position == pytest.approx(whole.state.position, abs=1e-9)) is same


@pytest.mark.parametrize("name", CHANGES)
def test_the_same_changes_at_the_same_steps_give_the_same_bits(box: Shape, name: str) -> None:
    def path() -> list[RigidState]:
        moving = falling(box)
        return advance(moving, 0.5) + advance(adjusted(moving, **CHANGES[name]), 1)

    assert path() == path()


def test_a_change_back_before_the_next_step_changes_nothing(box: Shape) -> None:
    moving, whole = falling(box), falling(box)
    for one in (moving, whole):
        advance(one, 0.5)
    adjusted(adjusted(moving, restitution=0, gravity=1), restitution=0.6, gravity=9.81)
    assert advance(moving, 1) == advance(whole, 1)


def test_velocity_and_spin_are_of_the_start(box: Shape) -> None:
    moving = falling(box)
    adjusted(moving, velocity=(0, 0, 2), spin=(4, 0, 0))
    assert moving.body.velocity(moving.state) == (0, 0, 2), "no step was taken: it starts so"
    path = advance(moving, 0.1)
    adjusted(moving, velocity=(5, 0, 0))
    assert moving.state is path[-1]
    moving.reset()
    assert moving.body.velocity(moving.state) == (5, 0, 0)
    assert moving.body.angular_velocity(moving.state) == pytest.approx((4, 0, 0), abs=1e-15)


@pytest.mark.parametrize("change", [{"gravity": 30}, {"friction": 0}, {"restitution": 1}, {"mass": 1e3}])
def test_a_stone_on_its_facet_sleeps_on(box: Shape, change: dict[str, Any]) -> None:
    moving = asleep(box)
    before = moving.state
    adjusted(moving, **change)
    assert moving.state == before
    moving.step()
    assert moving.settled


def test_a_stone_that_may_not_sleep_any_more_wakes(box: Shape) -> None:
    assert not adjusted(asleep(box), sleeping=False).state.asleep


def test_a_stone_that_the_classic_model_balanced_falls_over(box: Shape) -> None:
    moving = rigid(box, (0.0, 0.0, 0.0), TILTED, model="classic", time_step=1 / 60)
    while not moving.state.asleep:
        moving.step()
    pose = moving.interpolated(1)
    assert adjusted(moving, model="rigid").interpolated(1) == pose
    woken = advance(moving, 30)
    assert not woken[0].asleep
    assert woken[-1].asleep
    assert -1e-5 < nearest(moving) < 1e-5


def test_the_hull_is_computed_once_for_a_stone(box: Shape) -> None:
    moving = falling(box)
    hull = moving.body.hull
    moving.surround((FLOOR, *WALLS))
    assert moving.body.hull is hull
    assert adjusted(moving, mass=7).body.hull is hull
    assert falling(box).body.hull is hull
    assert falling(replace(box)).body.hull is not hull


def test_without_a_solver_the_model_rigid_is_refused_and_classic_goes_on(
    box: Shape, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing() -> None:
        raise SolverUnavailableError("none")

    monkeypatch.setitem(MODELS, "rigid", MODELS["rigid"]._replace(require=missing))
    with pytest.raises(SolverUnavailableError):
        rigid(box)
    moving = classic(box)
    advance(moving, 0.1)
    before = moving.state
    with pytest.raises(SolverUnavailableError):
        moving.adjust(moving.settings.model_copy(update={"model": "rigid"}))
    assert (moving.settings.model, moving.state) == ("classic", before)
