"""Points where a stone touches, or is about to touch, a surface."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from culet.simulation.rigid_body.body import MatrixRows, RigidBody
from culet.simulation.rigid_body.motion import BodyMotion, centre_gap, gaps
from culet.simulation.rigid_body.rotation import rotate
from culet.simulation.rigid_body.state import Triple

Symmetric = tuple[float, float, float, float, float, float]
"""xx, yy, zz, xy, xz, yz."""

TOUCH = 1e-6
"""R. A vertex nearer than this touches. Larger: the stone rests visibly above the floor, and facets less than the angle
TOUCH / size apart are one; smaller: events must be found more exactly, which costs a little."""


@dataclass(slots=True)
class Contact:
    """One vertex at one surface. `impulse` is what the solver finds."""

    surface: int
    vertex: int
    gap: float
    """R."""
    normal: Triple
    arm: Triple
    """From the centre of mass to the vertex, world axes, R."""
    mass: Symmetric
    """Inverse of K, which takes an impulse at the vertex to the change of the vertex's velocity, 1/mass."""
    normal_inverse_mass: float
    """n . K n."""
    slip_mass: float
    """1 / trace of K across the normal: a step against slip that never overshoots, in whatever direction."""
    impulse: Triple = (0.0, 0.0, 0.0)
    """mass R/s."""


def contacts(motion: BodyMotion, body: RigidBody, reach: float = TOUCH) -> list[Contact]:
    """The vertices nearer to a surface than `reach`, in canonical order: by surface, then as in the hull."""
    near = [
        (number, vertex, float(distances[vertex]))
        for number, surface in enumerate(body.surfaces)
        if centre_gap(motion, surface) <= body.hull.radius + reach
        for distances in (gaps(motion, body, surface),)
        for vertex in (distances <= reach).nonzero()[0].tolist()
    ]
    return contacts_of(motion, body, near) if near else []


def contacts_of(motion: BodyMotion, body: RigidBody, vertices: Iterable[tuple[int, int, float]]) -> list[Contact]:
    """Of those (surface, vertex, gap)."""
    turning = world_inverse_inertia(motion, body)
    return [_contact(motion, body, turning, surface, vertex, gap) for surface, vertex, gap in vertices]


def closing_speed(point: Contact, velocity: Triple, omega: Triple) -> float:
    """Of the vertex towards the surface, R/s; negative: it leaves. World axes, R/s and rad/s."""
    (vx, vy, vz), (wx, wy, wz), (x, y, z), (a, b, c) = velocity, omega, point.arm, point.normal
    return -((vx + wy * z - wz * y) * a + (vy + wz * x - wx * z) * b + (vz + wx * y - wy * x) * c)


def world_inverse_inertia(motion: BodyMotion, body: RigidBody) -> MatrixRows:
    """R I^-1 R^T, 1 / (mass R^2)."""
    q = motion.orientation
    return (
        body.angular_velocity_at(q, (1.0, 0.0, 0.0)),
        body.angular_velocity_at(q, (0.0, 1.0, 0.0)),
        body.angular_velocity_at(q, (0.0, 0.0, 1.0)),
    )


def _contact(
    motion: BodyMotion, body: RigidBody, turning: MatrixRows, surface: int, vertex: int, gap: float
) -> Contact:
    normal = body.surfaces[surface].normal
    arm = rotate(motion.orientation, body.hull.points[vertex])
    k = _inverse_mass(1 / body.mass, turning, arm)
    (a, b, c), (xx, yy, zz, xy, xz, yz) = normal, k
    along = xx * a * a + yy * b * b + zz * c * c + 2 * (xy * a * b + xz * a * c + yz * b * c)
    return Contact(surface, vertex, gap, normal, arm, _inverse(k), along, 1 / (xx + yy + zz - along))


def _inverse_mass(light: float, turning: MatrixRows, arm: Triple) -> Symmetric:
    """K = 1/m - [r] J [r], where [r] p = r x p: column j is e_j / m + (J (r x e_j)) x r."""
    x, y, z = arm
    (jxx, jxy, jxz), (_, jyy, jyz), (_, _, jzz) = turning
    ax, ay, az = jxy * z - jxz * y, jyy * z - jyz * y, jyz * z - jzz * y
    bx, by, bz = jxz * x - jxx * z, jyz * x - jxy * z, jzz * x - jxz * z
    cx, cy = jxx * y - jxy * x, jxy * y - jyy * x
    return (
        light + ay * z - az * y,
        light + bz * x - bx * z,
        light + cx * y - cy * x,
        az * x - ax * z,
        ax * y - ay * x,
        bx * y - by * x,
    )


def _inverse(k: Symmetric) -> Symmetric:
    xx, yy, zz, xy, xz, yz = k
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    scale = 1 / (xx * a + xy * b + xz * c)
    return (
        a * scale,
        (xx * zz - xz * xz) * scale,
        (xx * yy - xy * xy) * scale,
        b * scale,
        c * scale,
        (xy * xz - xx * yz) * scale,
    )
