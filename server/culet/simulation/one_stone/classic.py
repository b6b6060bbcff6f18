"""The motion model `classic`: free fall, and a sphere that bounces on the floor, as the report published it.

In one step of h seconds, in this order (P momentum, L angular momentum, X position, q orientation):

    P.y -= m g h;  V = P / m;  X += V h                               symplectic Euler
    omega = R I^-1 R^T L;  q += h/2 (0, omega) q;  q /= |q|           explicit Euler
    if the bounding sphere reaches below the floor:
        X.y = floor + 1
        if V.y < 0:  V.y = 0 if V.y > -threshold, else -restitution V.y
        V.x, V.z *= tangential damping
        L += random torque if |V.y| > random torque speed, else L *= angular damping

Two things differ from the report's program, and one is added:

- Where the threshold stops the stone, the program clears V.y but forgets P.y, from which the next step makes V.y anew,
  so that the stop does not last. Here both are cleared.
- The program's random torque comes from the C library's `rand()`. Here it is a function of the seed and the number of
  hard impacts.
- The stone falls asleep once it can never leave the floor again and hardly moves (see `_settled`).

What the report leaves out is left out here too. Walls do not stop the stone. The contact is the lowest point of the
bounding sphere, whether the stone is convex or not, and has no lever arm: any orientation is an equilibrium, and the
stone comes to rest at an angle that no real stone has. The random torque puts energy in. In flight L is exact, but q
follows it to first order in h only, so that the energy of a tumbling stone drifts.
"""

from __future__ import annotations

import numpy as np

from culet.scene.room import FLOOR_Y
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.floor import BOUNDING_RADIUS, sphere_gap
from culet.simulation.rigid_body.rotation import euler_step, rotate_back
from culet.simulation.rigid_body.settings import SimulationSettings
from culet.simulation.rigid_body.state import RigidState, Touch, Triple

SLEEP_SPEED = 1e-4
"""R/s. A slower slide ends; with the report's damping it would have gone another 3e-5 R, some hundredth of a pixel."""
SLEEP_SPIN = 1e-4
"""rad/s. A slower turn ends; with the report's damping it would have gone another 1e-5 rad."""


def step(state: RigidState, settings: SimulationSettings, body: RigidBody) -> RigidState:
    """The state one fixed step later."""
    h, mass = settings.time_step, body.mass
    px, py, pz = state.momentum
    py -= mass * settings.gravity * h
    x, y, z = state.position
    x, y, z = x + px / mass * h, y + py / mass * h, z + pz / mass * h
    angular, impacts, asleep = state.angular_momentum, state.impacts, False
    orientation = euler_step(state.orientation, body.angular_velocity(state), h)

    if y - BOUNDING_RADIUS < FLOOR_Y:
        y = FLOOR_Y + BOUNDING_RADIUS
        if py < 0:
            py = 0.0 if py / mass > -settings.velocity_threshold else -settings.restitution * py
        px *= settings.tangential_damping
        pz *= settings.tangential_damping
        if abs(py / mass) > settings.random_torque_speed:
            kick_x, kick_z = random_torque(settings.seed, impacts, settings.random_torque)
            angular = (angular[0] + kick_x, angular[1], angular[2] + kick_z)
            impacts += 1
        else:
            angular = _times(angular, settings.angular_damping)
            landed = RigidState(0, 0.0, (x, y, z), orientation, (px, py, pz), angular)
            asleep = _settled(landed, settings, body)

    momentum = (px, py, pz)
    if asleep:
        momentum = angular = (0.0, 0.0, 0.0)
    time = state.time + h
    return RigidState(state.step + 1, time, (x, y, z), orientation, momentum, angular, impacts, asleep, state.coarse)


def touch(state: RigidState, body: RigidBody) -> Touch:
    """How the bounding sphere meets the floor; the clearance is the real stone's, which sinks in or floats."""
    gap = sphere_gap(state.position)
    # the world's y of a vertex v is (R v).y = v.(R^T e_y): one turned axis instead of all vertices turned
    up = rotate_back(state.orientation, (0.0, 1.0, 0.0))
    lowest = state.position[1] + float((body.shape.vertices @ np.array(up)).min())
    return Touch(int(gap <= 0), max(-gap, 0.0), lowest - FLOOR_Y)


def random_torque(seed: int, impacts: int, largest: float) -> tuple[float, float]:
    """Changes of angular momentum about x and z, each uniform in +-`largest`, at a hard impact after `impacts` others.

    A counter-based draw: there is no generator whose state could be lost. It takes the raw bits of PCG64, which NumPy
    promises never to change (NEP 19), and not a distribution of `Generator`, which it may.
    """
    bits = np.random.PCG64([seed, impacts])
    about_x, about_z = ((int(bits.random_raw()) >> 11) * 2.0**-53 for _ in range(2))
    return (about_x - 0.5) * 2 * largest, (about_z - 0.5) * 2 * largest


def _settled(landed: RigidState, settings: SimulationSettings, body: RigidBody) -> bool:
    """Whether a stone that has just landed will never leave the floor again, and hardly slides or turns.

    If it leaves with V.y <= g h, gravity turns it round before it has moved; it lands with at most g h, and leaves with
    at most restitution g h <= g h: the same again, for ever. Hence the stone rests at the report's 1/30 s too, although
    g h = 0.33 R/s is above its threshold of 0.1 R/s, and V.y tends to g h restitution / (1 + restitution), not to 0.
    """
    vx, vy, vz = body.velocity(landed)
    if vy > settings.gravity * settings.time_step or vx * vx + vz * vz > SLEEP_SPEED**2:
        return False
    wx, wy, wz = body.angular_velocity(landed)
    return wx * wx + wy * wy + wz * wz <= SLEEP_SPIN**2


def _times(v: Triple, factor: float) -> Triple:
    return (v[0] * factor, v[1] * factor, v[2] * factor)
