"""Free rotation against closed forms, and the order of every integrator, measured."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from culet.geometry.shape import MassProperties, Shape
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.free_rotation import INTEGRATORS, MAX_DIVISIONS, rkmk4, turned
from culet.simulation.rigid_body.rotation import rotate, rotate_back
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, Triple
from simulation.jacobi import FreeTop
from simulation.solids import UPRIGHT

MOMENTS = (1.0, 1.4, 2.1)
MIXED: Triple = (3.0, 4.0, 3.5)


def body_of(stone: Shape, moments: Triple, mass: float = 1) -> RigidBody:
    shaped = replace(stone, mass=MassProperties(stone.mass.volume, np.diag(moments)))
    return RigidBody.of(SimulationSettings.model_validate({"mass": mass}), shaped)


def energy(body: RigidBody, q: Quaternion, momentum: Triple) -> float:
    return 0.5 * float(np.dot(momentum, body.angular_velocity_at(q, momentum)))


def after(body: RigidBody, omega: Triple, integrator: str, step: float, steps: int) -> tuple[Quaternion, Triple]:
    q, momentum = UPRIGHT, body.angular_momentum(UPRIGHT, omega)
    for _ in range(steps):
        q = INTEGRATORS[integrator](body, q, momentum, step)
    return q, momentum


@pytest.mark.parametrize("omega", [MIXED, (6.0, 1.0, 0.5), (0.3, 1.0, 5.0), (-1.0, 2.0, -3.0), (2.0, -1.0, -0.2)])
def test_tumbling_follows_jacobis_elliptic_functions(box: Shape, omega: Triple) -> None:
    body = body_of(box, MOMENTS)
    q, momentum = after(body, omega, "rkmk4", 1 / 960, 4 * 960)
    in_body = rotate_back(q, body.angular_velocity_at(q, momentum))
    assert in_body == pytest.approx(FreeTop(MOMENTS, omega).omega(4.0), abs=4e-9)  # measured up to 4e-10


def test_a_symmetric_stone_precesses_about_its_angular_momentum(box: Shape) -> None:
    """The rates are L / I1 in space, and (I1 - I3) w3 / I1 in the stone (Landau and Lifshitz, section 33)."""
    body, omega = body_of(box, (1.0, 1.0, 1.6)), (2.0, 0.0, 3.0)
    q, momentum = after(body, omega, "rkmk4", 1 / 480, 960)
    axis = np.array(rotate(q, (0.0, 0.0, 1.0)))
    unit = np.array(momentum) / np.linalg.norm(momentum)
    start = np.array([0.0, 0.0, 1.0])
    angle = np.linalg.norm(momentum) / 1.0 * 2.0
    expected = (
        start * math.cos(angle)
        + np.cross(unit, start) * math.sin(angle)
        + unit * (unit @ start) * (1 - math.cos(angle))
    )
    assert axis == pytest.approx(expected, abs=5e-10)  # measured 5e-11


def test_a_spin_about_the_intermediate_axis_turns_over_when_jacobi_says(box: Shape) -> None:
    body, omega = body_of(box, MOMENTS), (1e-2, 3.0, 0.0)
    top = FreeTop(MOMENTS, omega)
    q, momentum, step = UPRIGHT, body.angular_momentum(UPRIGHT, omega), 1 / 480
    crossings, before = [], 3.0
    for n in range(1, 20 * 480):
        q = rkmk4(body, q, momentum, step)
        now = rotate_back(q, body.angular_velocity_at(q, momentum))[1]
        if now * before < 0:
            crossings.append((n - now / (now - before)) * step)
        before = now
    assert len(crossings) >= 2
    assert crossings[1] - crossings[0] == pytest.approx(top.flip_time, rel=2e-8)  # measured 2e-9


@pytest.mark.parametrize(
    ("integrator", "order"),
    [("rkmk4", 4), ("rk4", 4), ("midpoint", 2), ("splitting", 2), ("symmetric_top", 2), ("euler", 1)],
)
def test_each_integrator_has_its_order(box: Shape, integrator: str, order: int) -> None:
    body = body_of(box, MOMENTS)
    exact, _ = after(body, MIXED, "rkmk4", 1 / 7680, 7680)

    def error(steps: int) -> float:
        q, _ = after(body, MIXED, integrator, 1 / steps, steps)
        return 2 * math.dist(q, exact)  # for small angles; an arc cosine would see nothing below 1e-8

    coarse, fine = error(240), error(480)
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.02)  # measured within 0.005


@pytest.mark.parametrize(
    ("integrator", "drift"),
    # measured -1.4e-9, -9e-10, +2.8e-7, +9.6e-7 (bounded) and +0.16
    [("rkmk4", 1e-8), ("rk4", 1e-8), ("midpoint", 3e-6), ("splitting", 1e-5), ("symmetric_top", 1e-5), ("euler", 0.2)],
)
def test_each_integrator_keeps_the_energy_of_ten_seconds_as_well_as_it_can(
    box: Shape, integrator: str, drift: float
) -> None:
    body = body_of(box, MOMENTS)
    q, momentum = after(body, MIXED, integrator, 1 / 240, 2400)
    start = energy(body, UPRIGHT, momentum)
    change = abs(energy(body, q, momentum) / start - 1)
    assert change < drift


def test_a_high_spin_is_divided_into_steps_that_follow_it(box: Shape) -> None:
    body = body_of(box, MOMENTS)
    momentum = body.angular_momentum(UPRIGHT, (30.0, 40.0, 35.0))
    whole = turned(body, UPRIGHT, momentum, 0.05, rkmk4)
    q = UPRIGHT
    for _ in range(5000):
        q = rkmk4(body, q, momentum, 1e-5)
    assert abs(sum(a * b for a, b in zip(q, whole, strict=True))) == pytest.approx(1, abs=1e-12)  # measured 6e-15


def test_a_spin_beyond_all_division_keeps_its_energy_all_the_same(box: Shape) -> None:
    body = body_of(box, MOMENTS)
    momentum = body.angular_momentum(UPRIGHT, (3e6, 4e6, 3.5e6))
    assert body.fastest_turn(UPRIGHT, momentum) / 30 > MAX_DIVISIONS
    q, start = UPRIGHT, energy(body, UPRIGHT, momentum)
    for _ in range(1000):
        q = turned(body, q, momentum, 1 / 30, rkmk4)
    assert energy(body, q, momentum) == pytest.approx(start, rel=1e-13, abs=0)  # measured 1e-15
    assert q != UPRIGHT


def test_a_stone_without_spin_does_not_turn(box: Shape) -> None:
    assert turned(body_of(box, MOMENTS), UPRIGHT, (0.0, 0.0, 0.0), 1.0, rkmk4) == UPRIGHT


@pytest.mark.parametrize("moments", [(1.0, 1.0, 1.6), (1.0, 1.6, 1.6), (1e-6, 0.3, 0.3), (1.0, 1.0, 1.0)])
def test_the_symmetric_top_is_exact_in_one_step(box: Shape, moments: Triple) -> None:
    """L, its energy, and the rate L / I at which the axis goes round."""
    body, omega = body_of(box, moments), (0.3, 2.0, 1.0)
    momentum = body.angular_momentum(UPRIGHT, omega)
    whole = INTEGRATORS["symmetric_top"](body, UPRIGHT, momentum, 2.0)
    parts = UPRIGHT
    for _ in range(1000):
        parts = INTEGRATORS["symmetric_top"](body, parts, momentum, 2e-3)
    assert abs(sum(a * b for a, b in zip(whole, parts, strict=True))) == pytest.approx(1, abs=1e-12)  # measured 2e-16
    assert energy(body, whole, momentum) == pytest.approx(energy(body, UPRIGHT, momentum), rel=1e-12, abs=0)  # 3e-16


@pytest.mark.parametrize("moments", [MOMENTS, (1e-6, 0.3, 0.31), (1.0, 1.0, 1.0), (1.0, 1.0, 1.9)])
def test_no_rotation_is_faster_than_its_bound(box: Shape, moments: Triple) -> None:
    body, omega = body_of(box, moments), (0.3, 2.0, 1.0)
    q, momentum = UPRIGHT, body.angular_momentum(UPRIGHT, omega)
    bound = body.fastest_turn(q, momentum)
    fastest = 0.0
    for _ in range(4000):
        q = turned(body, q, momentum, 5e-3, rkmk4)
        fastest = max(fastest, math.hypot(*body.angular_velocity_at(q, momentum)))
    assert fastest <= bound * 1.005  # the needle's, of second order, is 0.1 % too fast
    assert bound < 1.2 * fastest
