"""Torque-free rotation in closed form, by Jacobi's elliptic functions (Landau and Lifshitz, Mechanics, section 37)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk, ellipkinc


class FreeTop:
    """Angular velocity in the body's principal axes for moments I1 < I2 < I3, from the angular velocity at time 0."""

    def __init__(self, moments: tuple[float, float, float], omega: tuple[float, float, float]) -> None:
        i = np.array(moments)
        w = np.array(omega)
        squared, twice_energy = float(((i * w) ** 2).sum()), float((i * w * w).sum())
        self._swapped = squared < twice_energy * i[1]
        if self._swapped:  # the angular momentum circles the axis of the smallest moment, not of the largest
            i, w = i[::-1], w[::-1]
        i1, i2, i3 = i
        self._amplitude = np.sqrt(
            [
                (twice_energy * i3 - squared) / (i1 * (i3 - i1)),
                (twice_energy * i3 - squared) / (i2 * (i3 - i2)),
                (squared - twice_energy * i1) / (i3 * (i3 - i1)),
            ]
        )
        self.rate = math.sqrt((i3 - i2) * (squared - twice_energy * i1) / (i1 * i2 * i3))
        self.parameter = float((i2 - i1) * (twice_energy * i3 - squared) / ((i3 - i2) * (squared - twice_energy * i1)))
        # w1 = s1 a1 cn, w2 = s2 a2 sn, w3 = s3 a3 dn; I2 w2' = (I3 - I1) w3 w1 fixes the product's sign, either way
        s1, s3 = 1.0, math.copysign(1.0, w[2])
        s2 = s1 * s3
        self._signs = np.array([s1, s2, s3])
        phase = math.atan2(s2 * w[1] / self._amplitude[1], s1 * w[0] / self._amplitude[0])
        self._start = float(ellipkinc(phase, self.parameter))

    @property
    def flip_time(self) -> float:
        """Between two turns over of the intermediate axis."""
        return float(2 * ellipk(self.parameter) / self.rate)

    def omega(self, time: float) -> NDArray[np.float64]:
        """(3,) rad/s, in the body's principal axes."""
        sn, cn, dn, _ = ellipj(self.rate * time + self._start, self.parameter)
        w = self._signs * self._amplitude * np.array([cn, sn, dn])
        return np.asarray(w[::-1] if self._swapped else w, np.float64)
