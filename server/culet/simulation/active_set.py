"""The impulses of contacts whose state is known: which of them stick, which slip and where to, which do not press.

Gauss-Seidel finds these states in a few passes, but then creeps: two vertices at the ends of a short edge take hundreds
of passes. With the states known the rest is linear, in the six velocities w of the body:

    M w = (P, L) + sum over sticking J' p + sum over slipping J' (n + mu d) p_n
    J w = target n (sticking),   n . J w = target (slipping)

There are usually more equations than the body has velocities, as more than three points carry it, so that p is not
unique. The method of multipliers (Hestenes 1969) does not mind: p = p_before - rho (J w - target n), a few times over.
"""

from __future__ import annotations

from collections.abc import Sequence

from culet.simulation.body import RigidBody
from culet.simulation.contact import Contact
from culet.simulation.linear import Matrix, inverse, times
from culet.simulation.motion import Motion
from culet.simulation.state import Triple

STIFFNESS = 1e3
"""rho in units of the mass. Larger: fewer iterations, more rounding."""
ITERATIONS = 5


def refine(
    motion: Motion, body: RigidBody, points: Sequence[Contact], targets: Sequence[float], friction: float
) -> None:
    """Replace the impulses by those that the states they show ask for; keep them where the states turn out wrong."""
    rho = STIFFNESS * body.mass
    rows, right, bonds = _mass_matrix(motion, body), [*motion.momentum, *motion.angular_momentum], []
    for index, (point, target) in enumerate(zip(points, targets, strict=True)):
        (a, b, c), (ix, iy, iz) = point.normal, point.impulse
        normal = ix * a + iy * b + iz * c
        if normal <= 0:
            continue
        sx, sy, sz = ix - normal * a, iy - normal * b, iz - normal * c
        slipping = friction == 0 or (sx * sx + sy * sy + sz * sz) >= (friction * normal * (1 - 1e-9)) ** 2
        if slipping:
            push = (ix / normal, iy / normal, iz / normal)
            bonds.append((index, _lever(point.arm, push), _lever(point.arm, point.normal), target, normal))
        else:
            for axis, part in (((1.0, 0.0, 0.0), ix), ((0.0, 1.0, 0.0), iy), ((0.0, 0.0, 1.0), iz)):
                along = axis[0] * a + axis[1] * b + axis[2] * c
                lever = _lever(point.arm, axis)
                bonds.append((index, lever, lever, target * along, part))
    for _, out, back, target, _ in bonds:
        for i, factor in enumerate(out):
            if factor != 0:
                stiff = rho * factor
                rows[i] = [value + stiff * other for value, other in zip(rows[i], back, strict=True)]
                right[i] += stiff * target
    system = inverse(rows)
    if system is None:
        return
    parts = [part for *_, part in bonds]
    for _ in range(ITERATIONS):
        loaded = right[:]
        for (_, out, *_), part in zip(bonds, parts, strict=True):
            loaded = [value + part * factor for value, factor in zip(loaded, out, strict=True)]
        w = times(system, loaded)
        parts = [
            part - rho * (sum([x * y for x, y in zip(back, w, strict=True)]) - target)
            for (_, _, back, target, _), part in zip(bonds, parts, strict=True)
        ]
    _accept(points, [(index, out, part) for (index, out, *_), part in zip(bonds, parts, strict=True)], friction)


def _accept(points: Sequence[Contact], found: list[tuple[int, list[float], float]], friction: float) -> None:
    impulses: dict[int, Triple] = {}
    for index, out, part in found:
        x, y, z = impulses.get(index, (0.0, 0.0, 0.0))
        impulses[index] = (x + out[0] * part, y + out[1] * part, z + out[2] * part)
    for index, (x, y, z) in impulses.items():
        a, b, c = points[index].normal
        normal = x * a + y * b + z * c
        slip = (x - normal * a) ** 2 + (y - normal * b) ** 2 + (z - normal * c) ** 2
        if normal < 0 or slip > (friction * normal * (1 + 1e-6)) ** 2 + 1e-300:
            return
    for index, impulse in impulses.items():
        points[index].impulse = impulse


def _lever(arm: Triple, force: Triple) -> list[float]:
    """Force and moment about the centre of mass, as one."""
    (x, y, z), (a, b, c) = arm, force
    return [a, b, c, y * c - z * b, z * a - x * c, x * b - y * a]


def _mass_matrix(motion: Motion, body: RigidBody) -> Matrix:
    m, q = body.mass, motion.orientation
    turning = [body.angular_momentum(q, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    return [
        [m, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, m, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, m, 0.0, 0.0, 0.0],
        *([0.0, 0.0, 0.0, *row] for row in turning),
    ]
