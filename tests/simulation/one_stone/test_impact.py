"""Impacts against closed forms, and what must hold of every impact."""

from __future__ import annotations

import math

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.simulation.one_stone.contact import Contact, closing_speed, contacts
from culet.simulation.one_stone.impact import impact
from culet.simulation.one_stone.impulses import solve
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, gaps, kinetic_energy
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.rigid_body.surfaces import FLOOR
from simulation.solids import TABLE_DOWN, about, random_body

SETTINGS = SimulationSettings.model_validate({"model": "rigid", "mass": 2})


def landed(
    stone: Shape, orientation: Quaternion, velocity: Triple, omega: Triple
) -> tuple[RigidBody, BodyMotion, list[Contact]]:
    """Touching the floor with its lowest vertices, in motion."""
    body = RigidBody.of(SETTINGS, stone)
    x, y, z = velocity
    motion = BodyMotion((0.0, 0.0, 0.0), orientation, (2 * x, 2 * y, 2 * z), body.angular_momentum(orientation, omega))
    motion = motion._replace(position=(0.0, -float(gaps(motion, body, FLOOR).min()), 0.0))
    return body, motion, contacts(motion, body)


def speeds(body: RigidBody, motion: BodyMotion, points: list[Contact]) -> list[float]:
    """Towards the floor, of each touching vertex."""
    velocity = (motion.momentum[0] / body.mass, motion.momentum[1] / body.mass, motion.momentum[2] / body.mass)
    omega = body.angular_velocity_at(motion.orientation, motion.angular_momentum)
    return [closing_speed(point, velocity, omega) for point in points]


@pytest.mark.parametrize("e", [0.0, 0.3, 0.7, 1.0])
def test_a_single_vertex_without_friction_gets_the_textbook_impulse(box: Shape, e: float) -> None:
    """J = (1 + e) v_n / K and dE = -(1 - e^2) v_n^2 / (2 K), K = 1/m + (r x n) . I^-1 (r x n)."""
    orientation = about((0.6, 0.0, 0.8), 0.5)
    body, before, points = landed(box, orientation, (0.4, -3.0, 0.2), (1.0, 2.0, -1.5))
    (point,) = points
    (closing,) = speeds(body, before, points)
    crossed = np.cross(point.arm, point.normal)
    k = 1 / 2 + crossed @ np.array(body.angular_velocity_at(orientation, tuple(crossed)))
    after = impact(before, body, points, e, 0)
    assert after.momentum == pytest.approx((0.8, -6 + (1 + e) * closing / k, 0.4), rel=1e-12, abs=0)
    lost = kinetic_energy(before, body) - kinetic_energy(after, body)
    assert lost == pytest.approx((1 - e * e) * closing**2 / (2 * k), rel=1e-10, abs=1e-12)  # measured 4e-16
    assert speeds(body, after, points) == pytest.approx([-e * closing], rel=1e-10, abs=1e-12)  # measured 7e-16


def test_a_flat_elastic_landing_keeps_its_energy_and_gains_no_spin(brilliant: Shape) -> None:
    """Eight vertices of the table at once: one pass of Gauss-Seidel would give three times the energy."""
    body, before, points = landed(brilliant, TABLE_DOWN, (0.0, -3.0, 0.0), (0.0, 0.0, 0.0))
    assert len(points) == 8
    after = impact(before, body, points, 1, 0.3)
    assert kinetic_energy(after, body) == pytest.approx(kinetic_energy(before, body), rel=1e-12)  # measured 0
    assert after.momentum == pytest.approx((0, 6, 0), abs=1e-11)  # measured 7e-13
    spin = body.angular_velocity_at(after.orientation, after.angular_momentum)
    assert spin == pytest.approx((0, 0, 0), abs=1e-11)  # measured 9e-13


@pytest.mark.parametrize("e", [0.0, 0.6])
def test_a_flat_landing_leaves_with_the_restitutions_share(brilliant: Shape, e: float) -> None:
    body, before, points = landed(brilliant, TABLE_DOWN, (0.0, -3.0, 0.0), (0.0, 0.0, 0.0))
    after = impact(before, body, points, e, 0.3)
    assert after.momentum == pytest.approx((0, 6 * e, 0), abs=1e-11)  # measured 4e-13


def test_a_slender_block_that_rocks_over_keeps_housners_share_of_its_spin(box: Shape) -> None:
    """Housner 1963: omega+ / omega- = 1 - 1.5 sin^2(alpha), alpha the half angle of the block at its corner.

    The block stands on its small face, turning about one bottom edge until the other hits, without restitution.
    """
    upright = about((0.0, 0.0, 1.0), math.pi / 2)  # the long axis x is vertical
    half_width, half_height = 3 / 7, 6 / 7
    omega = (0.0, 0.0, 1.0)
    # the corner at x = -half_width (left) is the pivot: v = omega x (centre - pivot)
    velocity = (-half_height, half_width, 0.0)
    body, before, points = landed(box, upright, velocity, omega)
    assert len(points) == 4
    assert max(speeds(body, before, points)) == pytest.approx(0, abs=1e-12)
    turned_back = (-velocity[0], -velocity[1], 0.0)
    body, before, points = landed(box, upright, turned_back, (0.0, 0.0, -1.0))
    after = impact(before, body, points, 0, 10)
    sine = half_width / math.hypot(half_width, half_height)
    spin = body.angular_velocity_at(upright, after.angular_momentum)
    assert spin == pytest.approx((0, 0, -(1 - 1.5 * sine**2)), abs=1e-11)  # measured 5e-13


def test_without_friction_tangential_momentum_is_untouched(brilliant: Shape) -> None:
    body, before, points = landed(brilliant, about((1.0, 0.0, 0.0), 0.7), (2.0, -3.0, -1.0), (1.0, 2.0, 3.0))
    after = impact(before, body, points, 0.5, 0)
    assert (after.momentum[0], after.momentum[2]) == (before.momentum[0], before.momentum[2])


def test_a_large_friction_stops_the_slip_of_the_vertex(box: Shape) -> None:
    body, before, points = landed(box, about((0.6, 0.0, 0.8), 0.5), (0.4, -3.0, 0.2), (1.0, 2.0, -1.5))
    after = impact(before, body, points, 0, 1e3)
    velocity = (after.momentum[0] / 2, after.momentum[1] / 2, after.momentum[2] / 2)
    omega = body.angular_velocity_at(after.orientation, after.angular_momentum)
    assert np.array(velocity) + np.cross(omega, points[0].arm) == pytest.approx([0, 0, 0], abs=1e-12)  # measured 1e-15


@pytest.mark.parametrize("heading", range(0, 360, 30))
def test_friction_does_not_prefer_a_direction(brilliant: Shape, heading: int) -> None:
    """A stone sliding on its table turns with its course, to rounding: no pyramid, no axes."""
    angle = math.radians(heading)
    x, z = math.cos(angle), -math.sin(angle)
    body, before, points = landed(brilliant, _on_its_table(angle), (4 * x, -1.0, 4 * z), (0.0, 0.0, 0.0))
    after = impact(before, body, points, 0, 0.3)
    along = after.momentum[0] * x + after.momentum[2] * z
    across = after.momentum[0] * z - after.momentum[2] * x
    assert along == pytest.approx(2 * 4 - 0.3 * 2 * 1, rel=1e-11)  # measured 3e-13
    assert across == pytest.approx(0, abs=1e-11)  # measured 1e-14


def _on_its_table(angle: float) -> Quaternion:
    """Table down, then turned about the vertical."""
    w, y = math.cos(angle / 2), math.sin(angle / 2)
    return (0.0, w, 0.0, -y)


def check(body: RigidBody, before: BodyMotion, e: float, friction: float) -> None:
    """No energy out of nothing, no way into the floor, no force outside the friction disc, no pull."""
    points = contacts(before, body)
    closing = speeds(body, before, points)
    after = impact(before, body, points, e, friction)
    scale = max(1.0, *(abs(speed) for speed in closing))
    energy = kinetic_energy(before, body)
    assert kinetic_energy(after, body) <= energy * (1 + 1e-12)
    if max(closing) <= 0:
        assert after == before
        return
    assert max(speeds(body, after, points)) <= 1e-6 * scale
    for point in points:
        (x, y, z) = point.impulse
        assert y >= 0
        assert math.hypot(x, z) <= friction * y * (1 + 1e-6) + 1e-12


@pytest.mark.parametrize("count", [1500, pytest.param(100_000, marks=pytest.mark.validation)])
def test_random_impacts_obey_energy_signorini_and_coulomb(brilliant: Shape, box: Shape, count: int) -> None:
    rng = np.random.default_rng(4)
    for number in range(count):
        body, motion = random_body((brilliant, box)[number % 2], rng)
        check(body, motion, float(rng.choice([0, 0.3, 0.6, 1])), float(rng.choice([0, 0.1, 0.3, 1, 10])))


def bounced(body: RigidBody, before: BodyMotion, restitution: float) -> BodyMotion:
    """By impulses alone, with friction, whatever that makes of the energy."""
    points = contacts(before, body)
    targets = [restitution * max(closing, 0.0) for closing in speeds(body, before, points)]
    return solve(before, body, points, targets, friction=1)


def test_restitution_that_would_make_energy_is_halved_and_friction_stays(brilliant: Shape) -> None:
    rng, halved = np.random.default_rng(6), 0
    for _ in range(300):
        body, before = random_body(brilliant, rng)
        energy, half = kinetic_energy(before, body), bounced(body, before, 0.5)
        if kinetic_energy(half, body) < energy < 0.999 * kinetic_energy(bounced(body, before, 1), body):
            halved += 1
            assert impact(before, body, contacts(before, body), restitution=1, friction=1) == half
    assert halved >= 10  # 29 with any gain


def test_the_order_of_the_vertices_does_not_matter(brilliant: Shape) -> None:
    rng = np.random.default_rng(8)
    order = rng.permutation(len(brilliant.vertices))
    shuffled = Shape(**{**vars(brilliant), "vertices": brilliant.vertices[order]})
    for _ in range(50):
        state = rng.bit_generator.state
        body, motion = random_body(brilliant, rng)
        rng.bit_generator.state = state
        other, same = random_body(shuffled, rng)
        assert motion == same
        assert impact(motion, body, contacts(motion, body), 0.5, 0.3) == impact(
            same, other, contacts(same, other), 0.5, 0.3
        )
