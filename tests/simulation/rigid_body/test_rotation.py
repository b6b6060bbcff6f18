"""Quaternions against SciPy's rotations and against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from culet.simulation.rigid_body.rotation import IDENTITY, euler_step, normalised, rotate, rotate_back, slerp
from culet.simulation.rigid_body.state import Quaternion, Triple

HALF = math.sqrt(0.5)


def random_rotations(count: int) -> list[Quaternion]:
    draws = np.random.default_rng(1).normal(size=(count, 4))
    return [normalised((w, x, y, z)) for w, x, y, z in draws.tolist()]


def scipy_rotation(q: Quaternion) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


@pytest.mark.parametrize("q", random_rotations(20))
def test_rotating_a_vector_agrees_with_scipy(q: Quaternion) -> None:
    v = (0.3, -1.2, 2.5)
    assert rotate(q, v) == pytest.approx(tuple(scipy_rotation(q).apply(v)), abs=4e-15)  # measured 1.4e-15


@pytest.mark.parametrize("q", random_rotations(20))
def test_rotating_back_undoes_rotating(q: Quaternion) -> None:
    v = (0.3, -1.2, 2.5)
    assert rotate_back(q, rotate(q, v)) == pytest.approx(v, abs=4e-15)  # measured 1.8e-15


def test_a_quarter_turn_about_y_takes_z_to_x() -> None:
    assert rotate((HALF, 0, HALF, 0), (0, 0, 1)) == pytest.approx((1, 0, 0), abs=1e-15)


@pytest.mark.parametrize("omega_h", [1e-6, 0.1, 1.0, 10.0, 1e6])
def test_an_euler_step_turns_by_twice_the_arc_tangent_of_half(omega_h: float) -> None:
    w, x, y, z = euler_step(IDENTITY, (0.0, omega_h * 30, 0.0), 1 / 30)
    assert 2 * math.atan2(y, w) == pytest.approx(2 * math.atan(omega_h / 2), rel=1e-15, abs=0)
    assert (x, z) == (0, 0)


def test_an_euler_step_falls_short_by_the_third_power_over_twelve() -> None:
    for angle in (0.1, 0.05, 0.025):
        w, _, y, _ = euler_step(IDENTITY, (0.0, angle, 0.0), 1.0)
        short = angle - 2 * math.atan2(y, w)
        assert short / (angle**3 / 12) == pytest.approx(1, abs=angle**2)  # the next term: 3/20 angle^2


def test_the_angular_velocity_is_in_world_axes() -> None:
    quarter_about_x: Quaternion = (HALF, HALF, 0, 0)  # takes the stone's y to the world's z
    turned = euler_step(quarter_about_x, (0.0, 0.0, 1e-3), 1.0)
    assert rotate(turned, (0, 1, 0)) == pytest.approx((0, 0, 1), abs=1e-15)  # turning about world z leaves it there


def test_ten_thousand_steps_keep_the_norm() -> None:
    q = IDENTITY
    for _ in range(10_000):
        q = euler_step(q, (1.0, -20.0, 3.0), 1 / 30)
    assert abs(sum(c * c for c in q) - 1) < 1e-15  # measured 2.2e-16


def test_no_spin_is_too_fast() -> None:
    q = euler_step((HALF, 0, 0, HALF), (1e60, -1e60, 3e59), 0.25)
    assert sum(c * c for c in q) == pytest.approx(1, abs=1e-15)


def test_slerp_meets_both_ends_to_the_bit() -> None:
    start, end = random_rotations(2)
    assert slerp(start, end, 0) == start
    assert slerp(start, end, 1) == end


def test_slerp_of_equal_poses_is_that_pose_to_the_bit() -> None:
    for q in random_rotations(20):
        assert slerp(q, q, 0.37) == q


@pytest.mark.parametrize("fraction", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("angle", [1e-9, 1e-7, 1e-5, 1e-3, 0.1, 3.0])
def test_slerp_agrees_with_scipy(angle: float, fraction: float) -> None:
    (start,) = random_rotations(1)
    step = Rotation.from_rotvec(np.array([0.6, 0.0, 0.8]) * angle)
    w, x, y, z = (step * scipy_rotation(start)).as_quat(scalar_first=True).tolist()
    ours = slerp(start, (w, x, y, z), fraction)
    theirs = Slerp([0, 1], Rotation.concatenate([scipy_rotation(start), step * scipy_rotation(start)]))(fraction)
    assert (scipy_rotation(ours) * theirs.inv()).magnitude() < 5e-15  # measured 6e-16 or less


def test_slerp_takes_the_shorter_way() -> None:
    small = euler_step(IDENTITY, (0.0, 0.2, 0.0), 1.0)
    negative: Quaternion = (-small[0], -small[1], -small[2], -small[3])  # the same rotation
    up: Triple = (0.0, 0.0, 1.0)
    assert rotate(slerp(IDENTITY, negative, 0.5), up) == pytest.approx(
        rotate(slerp(IDENTITY, small, 0.5), up), abs=1e-15
    )
