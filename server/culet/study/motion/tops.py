"""A free top of three unequal moments, and where it is after a while: what the integrators are judged by."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.rotation import product
from culet.simulation.rigid_body.state import Quaternion, Triple

TOP_MOMENTS = (1.0, 1.4, 2.1)
"""mass R^2, all different: the general top."""
TOP_SPIN: Triple = (3.0, 4.0, 3.5)
"""rad/s."""
TOP_SECONDS = 4.0
TOLERANCE = 1e-13
"""Of DOP853 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I), relative and absolute."""


def rotation_truth(body: RigidBody, orientation: Quaternion, angular_momentum: Triple, seconds: float) -> Quaternion:
    """The attitude after a free rotation, to some 1e-12 rad."""

    def rate(_: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
        w, x, y, z = q / np.linalg.norm(q)
        a, b, c = body.angular_velocity_at((w, x, y, z), angular_momentum)
        return np.array(product((0.0, a / 2, b / 2, c / 2), (w, x, y, z)))

    solution = solve_ivp(rate, (0, seconds), orientation, "DOP853", rtol=TOLERANCE, atol=TOLERANCE)
    w, x, y, z = (solution.y[:, -1] / np.linalg.norm(solution.y[:, -1])).tolist()
    return w, x, y, z


def angle_between(a: Quaternion, b: Quaternion) -> float:
    """rad of the turn that takes one attitude into the other; exact for small angles too."""
    conjugate = (a[0], -a[1], -a[2], -a[3])
    w, x, y, z = product(b, conjugate)
    return 2 * math.atan2(math.sqrt(x * x + y * y + z * z), abs(w))
