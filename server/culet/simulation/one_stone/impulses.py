"""The impulses at all contacts together: no vertex goes on into a surface, and Coulomb's friction opposes slip.

The compiled solver finds them (`solver/one_stone.c` has the equations), to the same bits on every machine.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from weakref import WeakKeyDictionary

from culet.simulation.one_stone.contact import Contact
from culet.simulation.rigid_body.body import RigidBody
from culet.simulation.rigid_body.motion import BodyMotion
from culet.simulation.rigid_body.state import Triple
from culet.simulation.solver.interface import CuletMotion, CuletPoint, Properties
from culet.simulation.solver.library import library

_POINT = struct.Struct("18d")
_IMPULSE = struct.Struct("120x3d")
"""Where a CuletPoint has it."""
_PROPERTIES: WeakKeyDictionary[RigidBody, Properties] = WeakKeyDictionary()


def solve(
    motion: BodyMotion, body: RigidBody, points: Sequence[Contact], targets: Sequence[float], friction: float
) -> BodyMotion:
    """The motion after the impulses, which are left in the contacts. Targets are velocities along the normals, R/s.

    MemoryError if there are more contacts than memory.
    """
    given = b"".join(
        _POINT.pack(*point.arm, *point.normal, *point.mass, point.normal_inverse_mass, point.slip_mass, target, 0, 0, 0)
        for point, target in zip(points, targets, strict=True)
    )
    buffer = (CuletPoint * len(points)).from_buffer_copy(given)
    moving = CuletMotion(motion.orientation, motion.momentum, motion.angular_momentum)
    if library().culet_stone_impulses(_properties(body), moving, len(points), buffer, friction):
        raise MemoryError("the impulses of a stone's contacts")
    for point, impulse in zip(points, _IMPULSE.iter_unpack(memoryview(buffer).cast("B")), strict=True):
        point.impulse = impulse
    (px, py, pz), (lx, ly, lz) = moving.momentum, moving.angular_momentum
    return motion._replace(momentum=(px, py, pz), angular_momentum=(lx, ly, lz))


def _properties(body: RigidBody) -> Properties:
    found = _PROPERTIES.get(body)
    if found is None:
        found = Properties(mass=body.mass)
        for own, rows in ((found.inertia, body.inertia), (found.inverse_inertia, body.inverse_inertia)):
            own[:] = [component for row in rows for component in row]
        _PROPERTIES[body] = found  # whole: other threads may look for it
    return found


def impulse_at(motion: BodyMotion, arm: Triple, impulse: Triple) -> BodyMotion:
    """The momenta after one impulse (mass R/s) at an arm from the centre of mass."""
    (px, py, pz), (lx, ly, lz), (x, y, z), (ix, iy, iz) = motion.momentum, motion.angular_momentum, arm, impulse
    return motion._replace(
        momentum=(px + ix, py + iy, pz + iz),
        angular_momentum=(lx + y * iz - z * iy, ly + z * ix - x * iz, lz + x * iy - y * ix),
    )
