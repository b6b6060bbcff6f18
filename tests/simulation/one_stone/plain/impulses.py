"""The impulses at all contacts together, in plain Python: what the compiled solver is held to, bit by bit.

For each contact, with velocity v after the impulses, its normal part v_n and tangential part v_t, impulse p likewise:

    v_n >= target,  p_n >= 0,  p_n (v_n - target) = 0          Signorini; target = -e v_n before, or -gap / h
    |p_t| <= mu p_n,  v_t = 0 or p_t = -mu p_n v_t / |v_t|     Coulomb, a disc: no direction is preferred

Projected Gauss-Seidel until nothing changes: after a single pass, a stone that lands flat and elastically on eight
vertices would leave with three times its energy. Each contact first tries to stick, which a 3 x 3 inverse answers
exactly. Where that takes more friction than there is, the normal part is solved, and the tangential part takes a step
against the slip and is put back onto the disc (a fixed point of that is Coulomb's law, whatever the step's length).
Every few passes `active_set` jumps to where they lead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from culet.simulation.one_stone.contact import Contact, world_inverse_inertia
from culet.simulation.rigid_body.body import MatrixRows, RigidBody
from culet.simulation.rigid_body.motion import BodyMotion
from simulation.one_stone.plain.active_set import refine

PASSES = 8
"""Over all contacts before the active set is refined."""
LAST_PASSES = 200
"""Of the last round: where the contacts' states do not settle, as with friction far above 1. And of a contact alone,
whose slip only has to find its direction."""
ROUNDS = 8
STALLED = 1e-8
"""Of the largest impulse: a smaller change that passes no longer reduce is two vertices that push against each other
along the edge between them, more and more: it moves nothing."""
CLOSING = 1e-6
"""The same where a vertex still closes its gap: the edge is about to tilt, and no impulses can stop both of its ends
along it to the last digit. That comes to 9e-7."""
TOLERANCE = 1e-10
"""Of the largest impulse: the change in a pass below which the impulses have converged."""


def solve(
    motion: BodyMotion, body: RigidBody, points: Sequence[Contact], targets: Sequence[float], friction: float
) -> BodyMotion:
    """The motion after the impulses, which are left in the contacts. Targets are velocities along the normals, R/s."""
    turning = world_inverse_inertia(motion, body)
    stalled = CLOSING if min(targets, default=0.0) < 0 else STALLED
    for point in points:
        point.impulse = (0.0, 0.0, 0.0)
    for round_ in range(ROUNDS):
        passes = PASSES if round_ < ROUNDS - 1 and len(points) > 1 else LAST_PASSES
        if _converged(motion, body, turning, points, targets, friction, passes, stalled if round_ > 0 else 0.0):
            break
        if round_ < ROUNDS - 1:
            refine(motion, body, points, targets, friction)
    else:
        if friction > 0:
            return _finished_without_friction(motion, body, points, targets)
    return with_impulses(motion, points)


def _finished_without_friction(
    motion: BodyMotion, body: RigidBody, points: Sequence[Contact], targets: Sequence[float]
) -> BodyMotion:
    """Where friction far above 1 keeps the contacts from agreeing (Painlevé): a further push along the normals.

    Without friction the problem is convex and has an answer, and more pressure leaves the impulses within the disc.
    """
    so_far = [point.impulse for point in points]
    moving = solve(with_impulses(motion, points), body, points, targets, 0)
    for point, (x, y, z) in zip(points, so_far, strict=True):
        a, b, c = point.impulse
        point.impulse = (a + x, b + y, c + z)
    return moving


def _converged(
    motion: BodyMotion,
    body: RigidBody,
    turning: MatrixRows,
    points: Sequence[Contact],
    targets: Sequence[float],
    friction: float,
    passes: int,
    stalled: float,
) -> bool:
    """Improve the contacts' impulses by Gauss-Seidel; whether a pass has left them as they were."""
    lightness, moving = 1 / body.mass, with_impulses(motion, points)
    px, py, pz = moving.momentum
    vx, vy, vz = px * lightness, py * lightness, pz * lightness
    wx, wy, wz = body.angular_velocity_at(moving.orientation, moving.angular_momentum)
    (jxx, jxy, jxz), (_, jyy, jyz), (_, _, jzz) = turning
    before = math.inf
    for _ in range(passes):
        changed = largest = 0.0
        for point, target in zip(points, targets, strict=True):
            x, y, z = point.arm
            a, b, c = point.normal
            ix, iy, iz = point.impulse
            ux, uy, uz = vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x
            leaving = ux * a + uy * b + uz * c
            excess = leaving - target
            pressed = ix * a + iy * b + iz * c
            if pressed <= 0 and excess >= 0:
                continue  # not pressed before, and not now
            sticks = False
            if friction > 0:
                xx, yy, zz, xy, xz, yz = point.mass
                ex, ey, ez = ux - target * a, uy - target * b, uz - target * c
                nx = ix - (xx * ex + xy * ey + xz * ez)
                ny = iy - (xy * ex + yy * ey + yz * ez)
                nz = iz - (xz * ex + yz * ey + zz * ez)
                normal = nx * a + ny * b + nz * c
                if normal >= 0:
                    sx, sy, sz = nx - normal * a, ny - normal * b, nz - normal * c
                    limit = friction * normal
                    sticks = sx * sx + sy * sy + sz * sz <= limit * limit
            if not sticks:
                normal = max(pressed - excess / point.normal_inverse_mass, 0.0)
                nx, ny, nz = normal * a, normal * b, normal * c
                if friction > 0:
                    step, limit = point.slip_mass, friction * normal
                    sx = ix - pressed * a - step * (ux - leaving * a)
                    sy = iy - pressed * b - step * (uy - leaving * b)
                    sz = iz - pressed * c - step * (uz - leaving * c)
                    length = math.sqrt(sx * sx + sy * sy + sz * sz)
                    part = limit / length if length > limit else 1.0
                    nx, ny, nz = nx + part * sx, ny + part * sy, nz + part * sz
            dx, dy, dz = nx - ix, ny - iy, nz - iz
            changed = max(changed, abs(dx), abs(dy), abs(dz))
            largest = max(largest, abs(nx), abs(ny), abs(nz))
            point.impulse = (nx, ny, nz)
            vx, vy, vz = vx + dx * lightness, vy + dy * lightness, vz + dz * lightness
            tx, ty, tz = y * dz - z * dy, z * dx - x * dz, x * dy - y * dx
            wx += jxx * tx + jxy * ty + jxz * tz
            wy += jxy * tx + jyy * ty + jyz * tz
            wz += jxz * tx + jyz * ty + jzz * tz
        if changed <= TOLERANCE * largest or 0.9 * before < changed <= stalled * largest:
            return True
        before = changed
    return False


def with_impulses(motion: BodyMotion, points: Sequence[Contact]) -> BodyMotion:
    """The momenta after the contacts' impulses: P += p, L += r x p."""
    (px, py, pz), (lx, ly, lz) = motion.momentum, motion.angular_momentum
    for point in points:
        (x, y, z), (ix, iy, iz) = point.arm, point.impulse
        px, py, pz = px + ix, py + iy, pz + iz
        lx, ly, lz = lx + y * iz - z * iy, ly + z * ix - x * iz, lz + x * iy - y * ix
    return motion._replace(momentum=(px, py, pz), angular_momentum=(lx, ly, lz))
