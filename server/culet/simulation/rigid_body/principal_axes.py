"""Principal axes of an inertia tensor, by Jacobi's rotations in plain floats: the same bits on every machine."""

from __future__ import annotations

import math
from typing import NamedTuple

from culet.simulation.rigid_body.state import Triple

SWEEPS = 12
"""Convergence is quadratic: a 3 x 3 tensor is diagonal to rounding after four or five."""


class PrincipalAxis(NamedTuple):
    """A direction about which a free body spins steadily."""

    direction: Triple
    """Unit, in the stone's axes."""
    moment: float
    """mass R^2."""


def principal_axes(tensor: tuple[Triple, Triple, Triple]) -> tuple[PrincipalAxis, PrincipalAxis, PrincipalAxis]:
    """Of a symmetric tensor, the smallest moment first (Golub and Van Loan, Matrix Computations, 8.5)."""
    a = [list(row) for row in tensor]
    v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for _ in range(SWEEPS):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if a[p][q] == 0:
                continue
            ratio = (a[q][q] - a[p][p]) / (2 * a[p][q])
            tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(1 + ratio * ratio))
            cosine = 1 / math.sqrt(1 + tangent * tangent)
            sine = tangent * cosine
            for row in range(3):
                a[row][p], a[row][q] = cosine * a[row][p] - sine * a[row][q], sine * a[row][p] + cosine * a[row][q]
                v[row][p], v[row][q] = cosine * v[row][p] - sine * v[row][q], sine * v[row][p] + cosine * v[row][q]
            for column in range(3):
                above, below = a[p][column], a[q][column]
                a[p][column], a[q][column] = cosine * above - sine * below, sine * above + cosine * below
            a[p][q] = a[q][p] = 0.0
    first, second, third = sorted(
        (PrincipalAxis((v[0][i], v[1][i], v[2][i]), a[i][i]) for i in range(3)), key=lambda axis: axis.moment
    )
    return first, second, third
