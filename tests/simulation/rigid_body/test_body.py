"""Mass and inertia of a body: momentum to velocity and back, energy, and tensors that are none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from culet.errors import InputError
from culet.geometry.shape import MassProperties, Shape
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.rotation import normalised
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import RigidState

SCENE_DEFAULT = SimulationSettings.model_validate({})
TILTED = normalised((0.9, 0.1, -0.3, 0.2))


def with_inertia(stone: Shape, tensor: NDArray[np.float64]) -> Shape:
    return replace(stone, mass=MassProperties(stone.mass.volume, tensor))


def test_angular_velocity_is_the_inverse_tensor_times_angular_momentum(box: Shape) -> None:
    body = RigidBody.of(SimulationSettings.model_validate({"mass": 5}), box)
    momentum = body.angular_momentum(TILTED, (1.0, -2.0, 0.5))
    to_world = Rotation.from_quat(TILTED, scalar_first=True).as_matrix()
    expected = to_world @ (5 * box.mass.inertia) @ to_world.T @ [1.0, -2.0, 0.5]
    assert momentum == pytest.approx(tuple(expected), abs=4e-15)  # measured 4e-16
    state = RigidState(0, 0.0, (0.0, 0.0, 0.0), TILTED, (0.0, 0.0, 0.0), momentum)
    assert body.angular_velocity(state) == pytest.approx((1.0, -2.0, 0.5), abs=4e-15)  # measured 7e-16


def test_energy_is_half_m_v2_plus_half_omega_i_omega_plus_m_g_height(box: Shape) -> None:
    body = RigidBody.of(SimulationSettings.model_validate({"mass": 5}), box)
    spin = body.angular_momentum((1.0, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    state = RigidState(0, 0.0, (0.0, 3.0, 0.0), (1.0, 0.0, 0.0, 0.0), (10.0, 0.0, 5.0), spin)
    # v = (2, 0, 1); I = 13/147 per mass; the sphere's lowest point is 3 above the floor when the centre is at y = 3
    assert body.velocity(state) == (2, 0, 1)
    assert body.energy(state, gravity=10) == pytest.approx(
        0.5 * 5 * 5 + 0.5 * 5 * 13 / 147 * 4 + 5 * 10 * 3, rel=1e-15, abs=0
    )


def test_a_needle_a_thousand_times_as_long_as_thick_keeps_its_digits(box: Shape) -> None:
    turn = Rotation.from_rotvec([0.3, -0.7, 0.4]).as_matrix()
    tensor = turn @ np.diag([0.3, 0.3, 1e-6]) @ turn.T
    body = RigidBody.of(SimulationSettings.model_validate({"mass": 1}), with_inertia(box, tensor))
    product = np.array(body.inertia) @ np.array(body.inverse_inertia)
    assert product == pytest.approx(np.eye(3), abs=1e-9)  # measured 8e-12; the condition number times rounding is 7e-11


@pytest.mark.parametrize(
    ("tensor", "reason"),
    [
        (np.diag([1.0, 1.0, 0.0]), "positive definite"),
        (np.diag([1.0, -1.0, -1.0]), "positive definite"),
        (np.diag([1.0, np.nan, 1.0]), "finite"),
        (np.diag([1.0, np.inf, 1.0]), "finite"),
        (np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), "positive definite"),
        (np.array([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), "symmetric"),
        (np.ones(3), "3 by 3"),
    ],
)
def test_a_tensor_that_no_body_has_is_refused(box: Shape, tensor: NDArray[np.float64], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        RigidBody.of(SCENE_DEFAULT, with_inertia(box, tensor))
