"""Impulses of contacts whose states are known, and the linear systems behind them."""

from __future__ import annotations

import numpy as np
import pytest

from culet.geometry.shape import Shape
from culet.simulation.one_stone.contact import contacts
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, velocities
from culet.simulation.rigid_body.settings import SimulationSettings
from simulation.one_stone.plain.active_set import refine
from simulation.one_stone.plain.impulses import with_impulses
from simulation.one_stone.plain.linear import factorised, solution
from simulation.solids import UPRIGHT, lowest


@pytest.mark.parametrize("size", [1, 2, 6])
def test_a_linear_system_is_solved_with_rows_in_any_order(size: int) -> None:
    rng = np.random.default_rng(size)
    for _ in range(50):
        matrix, right = rng.normal(size=(size, size)), rng.normal(size=size)
        matrix[0, 0] = 0 if size > 1 else 1  # so that it cannot go without exchanging rows
        factors = factorised(matrix.tolist())
        assert factors is not None
        found = np.array(solution(factors, right.tolist()))
        assert matrix @ found == pytest.approx(right, abs=1e-12 * (1 + np.abs(found).max()))  # measured 2e-15 of that


def test_a_singular_matrix_is_told() -> None:
    assert factorised([[1.0, 2.0], [2.0, 4.0]]) is None
    assert factorised([[0.0]]) is None


@pytest.mark.parametrize("changes", [{}, {"mass": 1e-9}])
@pytest.mark.parametrize(("friction", "slips"), [(1e3, False), (0.1, True)])
def test_refining_solves_four_corners_that_stick_or_slip(
    box: Shape, changes: dict[str, float], friction: float, slips: bool
) -> None:
    """The default mass is a whole number; two corners would be enough, so that the impulses are not unique."""
    settings = SimulationSettings.model_validate(changes)
    body, mass = RigidBody.of(settings, box), settings.mass
    motion = BodyMotion((0.0, lowest(box), 0.0), UPRIGHT, (2 * mass, -1 * mass, 0.0), (0.0, 0.0, 0.0))
    points = contacts(motion, body)
    assert len(points) == 4
    for point in points:  # as Gauss-Seidel's first passes would leave them: pressed, and rubbed against the slip
        point.impulse = (-0.1 * 0.2 * mass if slips else 0.0, 0.2 * mass, 0.0)
    for _ in range(2):
        refine(motion, body, points, [0.0] * 4, friction)
    velocity, omega = velocities(with_impulses(motion, points), body)
    slip = [np.array(velocity) + np.cross(omega, point.arm) for point in points]
    expected = [2 - 0.1, 0, 0] if slips else [0, 0, 0]
    assert np.array(slip) == pytest.approx(np.tile(expected, (4, 1)), abs=1e-9)  # measured 1e-12; 7e-8 after one
