"""Rotations as unit quaternions w, x, y, z, in plain floats.

Only +, -, x, / and square roots, all of which IEEE 754 rounds in one way, take part in stepping, so that a run is the
same to the bit on every machine; `slerp` is for pictures only and may use the machine's trigonometry.
"""

from __future__ import annotations

import math

from culet.simulation.rigid_body.state import Quaternion, Triple

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


def rotate(q: Quaternion, v: Triple) -> Triple:
    """q v q*: from the stone's axes to the world's."""
    w, x, y, z = q
    a, b, c = v
    # v + 2 w (u × v) + 2 u × (u × v), with u the vector part of q: 18 products where the matrix needs 27
    s, t, r = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (a + w * s + (y * r - z * t), b + w * t + (z * s - x * r), c + w * r + (x * t - y * s))


def rotate_back(q: Quaternion, v: Triple) -> Triple:
    """q* v q: from the world's axes to the stone's."""
    w, x, y, z = q
    return rotate((w, -x, -y, -z), v)


def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """p q: the rotation q, then p."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def normalised(q: Quaternion) -> Quaternion:
    """q divided by its norm, which must not be 0."""
    w, x, y, z = q
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    return (w / norm, x / norm, y / norm, z / norm)


def euler_step(q: Quaternion, omega: Triple, time_step: float) -> Quaternion:
    """One explicit Euler step of q' = (0, omega) q / 2 with world angular velocity `omega` (rad/s), normalised.

    Turns by 2 atan(h |omega| / 2): less than h |omega| by its third power over 12, and below half a turn at any spin.
    """
    w, x, y, z = q
    half = 0.5 * time_step
    a, b, c = half * omega[0], half * omega[1], half * omega[2]
    return normalised(
        (
            w - (a * x + b * y + c * z),
            x + (a * w + b * z - c * y),
            y + (b * w + c * x - a * z),
            z + (c * w + a * y - b * x),
        )
    )


def slerp(start: Quaternion, end: Quaternion, fraction: float) -> Quaternion:
    """The rotation `fraction` of the shorter way from `start` to `end` (Shoemake 1985); both ends are met exactly."""
    if fraction <= 0 or start == end:  # equal poses must stay equal to the bit: a still image refines only then
        return start
    if fraction >= 1:
        return end
    cosine = sum(a * b for a, b in zip(start, end, strict=True))
    sign = -1.0 if cosine < 0 else 1.0  # q and -q are the same rotation
    angle = math.acos(min(abs(cosine), 1.0))
    if angle < 1e-6:  # the quotient of sines loses its digits; the chord is as good: its error is of order angle^3
        from_start, from_end = 1 - fraction, fraction
    else:
        from_start = math.sin((1 - fraction) * angle) / math.sin(angle)
        from_end = math.sin(fraction * angle) / math.sin(angle)
    w, x, y, z = (from_start * a + sign * from_end * b for a, b in zip(start, end, strict=True))
    return normalised((w, x, y, z))
