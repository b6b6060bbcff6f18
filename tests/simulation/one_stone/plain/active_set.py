"""The impulses of contacts whose state is known: which of them stick, which slip and where to, which do not press.

Gauss-Seidel finds these states in a few passes, but then creeps: two vertices at the ends of a short edge take hundreds
of passes. With the states known the rest is linear, in the six velocities w of the body:

    M w = (P, L) + sum over sticking J' p + sum over slipping J' (n + mu d) p_n
    J w = target n (sticking),   n . J w = target (slipping)

There are usually more equations than the body has velocities, as more than three points carry it, so that p is not
unique. The method of multipliers (Hestenes 1969) does not mind: p = p_before - rho (J w - target n), a few times over.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from culet.simulation.one_stone.contact import Contact
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion
from culet.simulation.rigid_body.state import Triple
from simulation.one_stone.plain.linear import factorised, solution

STIFFNESS = 1e3
"""rho in units of the mass. Larger: fewer iterations, more rounding."""
ITERATIONS = 5
ATTEMPTS = 4
AXES: tuple[Triple, Triple, Triple] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def refine(
    motion: BodyMotion, body: RigidBody, points: Sequence[Contact], targets: Sequence[float], friction: float
) -> None:
    """Replace the impulses by those that the states which they show ask for.

    A contact that would have to pull is let go of, one that would need more friction than there is slips, and the rest
    is solved again; after a few attempts the impulses are what was found, put back onto their cones.
    """
    mass_matrix, momenta = _mass_matrix(motion, body), np.array([*motion.momentum, *motion.angular_momentum])
    impulses = [point.impulse for point in points]
    for _ in range(ATTEMPTS):
        solved = _solved(mass_matrix, momenta, points, targets, friction, impulses, STIFFNESS * body.mass)
        if solved is None:
            return
        impulses = [_on_cone(point, impulse, friction) for point, impulse in zip(points, solved, strict=True)]
        if impulses == solved:
            break
    for point, impulse in zip(points, impulses, strict=True):
        point.impulse = impulse


def _solved(
    mass_matrix: NDArray[np.float64],
    momenta: NDArray[np.float64],
    points: Sequence[Contact],
    targets: Sequence[float],
    friction: float,
    impulses: Sequence[Triple],
    rho: float,
) -> list[Triple] | None:
    bonds = []
    for index, (point, target, (ix, iy, iz)) in enumerate(zip(points, targets, impulses, strict=True)):
        a, b, c = point.normal
        normal = ix * a + iy * b + iz * c
        if normal <= 0:
            continue
        sx, sy, sz = ix - normal * a, iy - normal * b, iz - normal * c
        limit = friction * normal * (1 - 1e-9)
        if friction == 0 or sx * sx + sy * sy + sz * sz >= limit * limit:
            push = (ix / normal, iy / normal, iz / normal)
            bonds.append((index, _lever(point.arm, push), _lever(point.arm, point.normal), target, normal))
        else:
            for axis, part, along in zip(AXES, (ix, iy, iz), (a, b, c), strict=True):
                lever = _lever(point.arm, axis)
                bonds.append((index, lever, lever, target * along, part))
    found = [(0.0, 0.0, 0.0)] * len(points)
    if not bonds:
        return found
    # element by element and summed in one order: the same bits everywhere, which a product of matrices is not
    out, back = np.array([bond[1] for bond in bonds]), np.array([bond[2] for bond in bonds])
    wanted, parts = np.array([bond[3] for bond in bonds]), np.array([bond[4] for bond in bonds])
    system = factorised((mass_matrix + (rho * out[:, :, None] * back[:, None, :]).sum(axis=0)).tolist())
    if system is None:
        return None
    right = momenta + (rho * out * wanted[:, None]).sum(axis=0)
    for _ in range(ITERATIONS):
        w = np.array(solution(system, (right + (parts[:, None] * out).sum(axis=0)).tolist()))
        parts = parts - rho * ((back * w).sum(axis=1) - wanted)
    for (index, (a, b, c, *_), *_), part in zip(bonds, parts.tolist(), strict=True):
        x, y, z = found[index]
        found[index] = (x + a * part, y + b * part, z + c * part)
    return found


def _on_cone(point: Contact, impulse: Triple, friction: float) -> Triple:
    """The impulse if it is one that the contact can give; else with less friction, or none at all."""
    (x, y, z), (a, b, c) = impulse, point.normal
    normal = x * a + y * b + z * c
    if normal <= 0:
        return (0.0, 0.0, 0.0)
    sx, sy, sz = x - normal * a, y - normal * b, z - normal * c
    slip, limit = math.sqrt(sx * sx + sy * sy + sz * sz), friction * normal
    if slip <= limit * (1 + 1e-9):
        return impulse
    part = limit / slip
    return (normal * a + part * sx, normal * b + part * sy, normal * c + part * sz)


def _lever(arm: Triple, force: Triple) -> list[float]:
    """Force and moment about the centre of mass, as one."""
    (x, y, z), (a, b, c) = arm, force
    return [a, b, c, y * c - z * b, z * a - x * c, x * b - y * a]


def _mass_matrix(motion: BodyMotion, body: RigidBody) -> NDArray[np.float64]:
    """(6, 6): velocities to momenta."""
    matrix = np.diag(np.full(6, body.mass, np.float64))
    matrix[3:, 3:] = [body.angular_momentum(motion.orientation, axis) for axis in AXES]
    return matrix
