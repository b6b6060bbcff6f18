"""The model `classic` against closed forms: free fall, bounce, threshold, damping, random torque, rest."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

from culet.geometry.shape import Shape
from culet.simulation.one_stone.classic import random_torque, step
from culet.simulation.one_stone.simulation import Simulation
from culet.simulation.rigid_body.state import RigidState
from simulation.solids import G, apexes, classic


def states(moving: Simulation, count: int) -> list[RigidState]:
    """The start and `count` states after it, by the model alone: sleeping is the caller's affair."""
    path = [moving.state]
    for _ in range(count):
        path.append(step(path[-1], moving.settings, moving.body))
    return path


def test_free_fall_is_symplectic_eulers_closed_form(box: Shape) -> None:
    h = 1 / 30
    for n, state in enumerate(states(classic(box, (1.0, 1000.0, -2.0), velocity=(3, 0, -1)), 300)):
        # v_n = -g h n, and y_n = y_0 + h (v_1 + ... + v_n)
        assert state.momentum[1] / 2 == pytest.approx(-G * h * n, rel=3e-14, abs=0)  # measured 2.9e-15
        closed = (1 + 3 * h * n, 1000 - G * h * h * n * (n + 1) / 2, -2 - h * n)
        assert state.position == pytest.approx(closed, rel=3e-14, abs=3e-14)  # measured 2e-15 for y
        assert state.time == pytest.approx(n * h, rel=1e-13, abs=0)


def test_mass_does_not_matter_to_the_fall(box: Shape) -> None:
    light, heavy = (states(classic(box, mass=2.0**power, random_torque=0, spin=(1, 2, 3)), 100) for power in (-20, 20))
    # scaling by a power of two commutes with rounding, so even bounces agree to the bit
    assert [s.position for s in light] == [s.position for s in heavy]
    assert [s.orientation for s in light] == [s.orientation for s in heavy]


def test_a_bounce_keeps_the_share_of_the_speed_that_restitution_says(box: Shape) -> None:
    path = states(classic(box, restitution=0.6), 60)
    bounce = next(i for i, state in enumerate(path) if state.momentum[1] > 0)
    arriving = path[bounce - 1].momentum[1] - 2 * G / 30
    assert path[bounce].momentum[1] == pytest.approx(-0.6 * arriving, rel=1e-15, abs=0)
    assert path[bounce].position[1] == 0  # back on the floor: the sphere's radius above it


def test_each_apex_is_restitution_squared_times_the_one_before(box: Shape) -> None:
    tops = apexes(states(classic(box, (0.0, 4.0, 0.0), restitution=0.8, time_step=1e-4), 60_000))
    assert len(tops) > 4
    for number, top in enumerate(tops[:5], start=1):
        assert top == pytest.approx(4 * 0.8 ** (2 * number), rel=2e-3)  # measured 2.4e-4, growing to 1.1e-3


def test_the_error_of_an_apex_is_of_first_order_in_the_step(box: Shape) -> None:
    def error(h: float) -> float:
        return abs(apexes(states(classic(box, restitution=0.8, time_step=h), round(2 / h)))[0] - 4 * 0.8**2)

    assert error(1e-4) < error(1e-2) / 30  # measured: 84 times; uneven, as the floor lies anywhere in a step


@pytest.mark.parametrize("h", [1 / 30, 1 / 100, 1 / 1000])
def test_an_elastic_bounce_never_rises_above_the_last(box: Shape, h: float) -> None:
    tops = apexes(states(classic(box, restitution=1, random_torque=0, time_step=h), round(30 / h)))
    assert len(tops) > 10
    assert tops[0] < 4
    assert all(after <= before + 1e-12 for before, after in pairwise(tops))


def test_a_slow_impact_stops_and_its_momentum_is_gone_too(box: Shape) -> None:
    moving = classic(box, (0.0, 0.0, 0.0), time_step=0.005, velocity_threshold=0.1)  # g h = 0.049 < 0.1
    for state in states(moving, 50)[1:]:
        assert state.momentum[1] == 0
        assert state.position[1] == 0


def test_an_impact_at_the_threshold_bounces(box: Shape) -> None:
    moving = classic(box, (0.0, 0.0, 0.0), time_step=0.005, velocity_threshold=G * 0.005, restitution=0.5)
    assert states(moving, 1)[1].momentum[1] == pytest.approx(0.5 * 2 * G * 0.005, rel=1e-15, abs=0)


def test_above_the_threshold_the_stone_still_rests_at_the_reports_step(box: Shape) -> None:
    h = 1 / 30  # g h = 0.33 R/s: more than the threshold of 0.1 R/s, so the speed tends to its fixed point instead of 0
    path = states(classic(box, (0.0, 0.0, 0.0), angular_damping=1), 60)  # a spin undamped: awake
    assert not any(state.asleep for state in path)
    assert all(state.position[1] == 0 for state in path)
    assert path[-1].momentum[1] / 2 == pytest.approx(G * h * 0.6 / 1.6, rel=1e-12, abs=0)


def test_each_contact_damps_the_slide(box: Shape) -> None:
    path = states(classic(box, (0.0, 0.0, 0.0), velocity=(2, 0, -1), tangential_damping=0.9), 10)
    for n, state in enumerate(path):
        assert state.momentum == pytest.approx((4 * 0.9**n, state.momentum[1], -2 * 0.9**n), rel=1e-14, abs=0)


def test_each_soft_contact_damps_the_spin(box: Shape) -> None:
    path = states(classic(box, (0.0, 0.0, 0.0), spin=(0, 3, 0), angular_damping=0.75), 10)
    for n, state in enumerate(path):
        assert state.angular_momentum == pytest.approx((0, 2 * 40 / 147 * 3 * 0.75**n, 0), rel=1e-14, abs=1e-15)
        assert state.impacts == 0


def test_a_hard_impact_kicks_about_x_and_z_instead_of_damping(box: Shape) -> None:
    path = states(classic(box, seed=3, random_torque=5), 60)
    hard = next(i for i, state in enumerate(path) if state.impacts == 1)
    before, after = path[hard - 1], path[hard]
    assert after.momentum[1] / 2 > 2
    about_x, about_z = random_torque(3, 0, 5)
    lx, ly, lz = before.angular_momentum
    assert after.angular_momentum == (lx + about_x, ly, lz + about_z)


def test_an_impact_is_soft_up_to_the_random_torque_speed(box: Shape) -> None:
    path = states(classic(box, random_torque_speed=1e6), 60)
    assert path[-1].impacts == 0
    landed = next(i for i, state in enumerate(path) if state.momentum[1] > 0)
    assert path[landed].angular_momentum == tuple(c * 0.75 for c in path[landed - 1].angular_momentum)


def test_the_random_torque_is_uniform_between_its_limits() -> None:
    kicks = [random_torque(11, impacts, 5) for impacts in range(2000)]
    about_x, about_z = zip(*kicks, strict=True)
    assert not set(about_x) & set(about_z)
    for draws in (about_x, about_z):
        assert all(-5 <= draw < 5 for draw in draws)
        assert max(draws) > 4.97
        assert min(draws) < -4.97
        # the mean of n uniform draws deviates by 10 / sqrt(12 n) = 0.065
        assert abs(sum(draws) / len(draws)) < 3 * 10 / math.sqrt(12 * len(draws))  # measured 0.05 and -0.14


def test_the_random_torque_depends_on_seed_and_impact_alone() -> None:
    assert random_torque(7, 4, 5) == random_torque(7, 4, 5)
    assert len({random_torque(seed, impacts, 5) for seed in range(10) for impacts in range(10)}) == 100
    assert random_torque(2**53 - 1, 0, 0) == (0, 0)


def test_angular_momentum_is_constant_in_flight_to_the_bit(box: Shape) -> None:
    path = states(classic(box, (0.0, 1000.0, 0.0), spin=(1, -2, 3)), 300)
    assert {state.angular_momentum for state in path} == {path[0].angular_momentum}


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_spin_about_a_principal_axis_keeps_its_axis_and_rate(box: Shape, axis: int) -> None:
    spin = [0.0, 0.0, 0.0]
    spin[axis] = 3.0
    moving = classic(box, (0.0, 1000.0, 0.0), spin=tuple(spin))
    for n, state in enumerate(states(moving, 30)):
        assert moving.body.angular_velocity(state) == pytest.approx(spin, abs=1e-13)  # measured 2e-15
        half_turn = math.atan(3 / 30 / 2) * n  # each step turns by 2 atan(h omega / 2)
        assert state.orientation[0] == pytest.approx(math.cos(half_turn), abs=1e-13)
        assert state.orientation[1 + axis] == pytest.approx(math.sin(half_turn), abs=1e-13)


def test_the_energy_of_a_tumbling_flight_drifts_by_first_order_in_the_step(box: Shape) -> None:
    def drift(h: float) -> float:
        moving = classic(box, gravity=0, spin=(1, 3, 0.5), time_step=h)
        start = moving.energy()
        for _ in range(round(1 / h)):
            moving.step()
        return moving.energy() / start - 1

    coarse, fine = drift(1 / 240), drift(1 / 480)
    assert fine > 0
    assert coarse / fine == pytest.approx(2, abs=0.1)  # measured 2.04; and a gain of 2 % a second at 1/30 s


def test_walls_do_not_stop_the_stone(box: Shape) -> None:
    path = states(classic(box, (0.0, 100.0, 0.0), velocity=(100, 0, 0)), 30)
    assert path[-1].position[0] == pytest.approx(100, rel=1e-13, abs=0)  # far behind a wall at 8


def test_a_stone_that_is_not_convex_touches_by_its_sphere_as_well(ring: Shape, box: Shape) -> None:
    assert not ring.convex
    hollow, solid = (states(classic(stone, inertia="cone"), 200) for stone in (ring, box))
    assert hollow == solid


def test_a_start_inside_the_floor_is_put_onto_it(box: Shape) -> None:
    after = states(classic(box, (0.0, -500.0, 0.0)), 1)[1]
    assert after.position == (0.0, 0.0, 0.0)
    a_steps_fall = G / 30
    assert after.momentum[1] / 2 == pytest.approx(0.6 * a_steps_fall, rel=1e-15, abs=0)  # no more than that gives back


def test_the_stone_comes_to_rest_and_falls_asleep(box: Shape) -> None:
    path = states(classic(box), 300)
    first = next(i for i, state in enumerate(path) if state.asleep)
    assert 2 < path[first].time < 8
    assert path[first].position[1] == 0
    assert path[first].momentum == path[first].angular_momentum == (0, 0, 0)


def test_what_sleep_cuts_off_cannot_be_seen(box: Shape, monkeypatch: pytest.MonkeyPatch) -> None:
    moving = classic(box, velocity=(1, 0, -2))
    asleep = states(moving, 400)[-1]
    monkeypatch.setattr("culet.simulation.one_stone.classic.SLEEP_SPEED", 0.0)
    monkeypatch.setattr("culet.simulation.one_stone.classic.SLEEP_SPIN", 0.0)
    awake = states(moving, 400)[-1]
    assert asleep.asleep
    assert not awake.asleep
    assert asleep.position == pytest.approx(awake.position, abs=4e-5)  # measured 2.7e-5 R: some 0.005 pixels
    assert asleep.orientation == pytest.approx(awake.orientation, abs=1e-10)  # measured 4e-12: the slide lasts longer


@pytest.mark.parametrize(
    "settings", [{"velocity": (0.001, 0, 0), "spin": (0, 0, 0)}, {"velocity": (0, 0, 0), "spin": (0, 0.001, 0)}]
)
def test_a_stone_that_slides_or_turns_stays_awake(box: Shape, settings: dict[str, Any]) -> None:
    assert not states(classic(box, (0.0, 0.0, 0.0), **settings), 1)[1].asleep


def test_a_stone_that_neither_slides_nor_turns_bounces_on(box: Shape) -> None:
    path = states(classic(box, (0.0, 0.5, 0.0), spin=(0, 0, 0), time_step=0.001, restitution=0.5), 2000)
    assert apexes(path)[:2] == pytest.approx(
        [0.5 * 0.25, 0.5 * 0.25**2], rel=0.05
    )  # measured 0.8 % and 2.7 %, by the step
    assert path[-1].asleep
