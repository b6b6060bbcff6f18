"""Outlines of brilliants: convex polygons whose every other corner, at a main facet, has a line that supports it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.spatial import ConvexHull

from culet.errors import MeshError

Points = NDArray[np.float64]
Way = Callable[[Points], float]
"""Below 0 inside an outline's curve, 0 on it."""


@dataclass(frozen=True, eq=False)
class GirdleOutline:
    """Of m mains, counter-clockwise. The axis is at (0, 0)."""

    corners: Points
    """(2 m, 2): at the mains, and between each and the next."""
    normals: Points
    """(m, 2) unit, outward: of the lines that support the outline at its mains."""

    @property
    def mains(self) -> int:
        return len(self.normals)

    @property
    def reach(self) -> Points:
        """(m,) distance of each support line from the axis."""
        return np.asarray(np.einsum("ij,ij->i", self.normals, self.corners[::2]))

    def meets(self) -> Points:
        """(m, 2) where each support line meets the next one's."""
        a, b = self.normals, np.roll(self.normals, -1, axis=0)
        h, i = self.reach, np.roll(self.reach, -1)
        det = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        return np.column_stack([h * b[:, 1] - i * a[:, 1], a[:, 0] * i - b[:, 0] * h]) / det[:, None]

    def stretched(self, x: float, y: float) -> GirdleOutline:
        """By these factors along x and y: an affine map, which keeps all meets."""
        normals = self.normals / [x, y]
        return GirdleOutline(self.corners * [x, y], normals / np.linalg.norm(normals, axis=1)[:, None])


def outline(mains: Sequence[tuple[float, float]], normals: Sequence[tuple[float, float]], curve: Way) -> GirdleOutline:
    """Mains on a curve, with the curve's normals there. The corner between two mains is where the way from the axis to
    the meet of their support lines leaves the curve."""
    unit = np.array(normals) / np.linalg.norm(normals, axis=1)[:, None]
    corners = np.repeat(np.array(mains, np.float64), 2, axis=0)
    found = GirdleOutline(corners, unit)
    for k, meet in enumerate(found.meets()):
        corners[2 * k + 1] = meet * (
            1.0 if curve(meet) <= 0 else brentq(lambda u, m=meet: curve(u * m), 0, 1, xtol=1e-15)
        )
    return found


def _leaves(curve: Way, way: Points) -> float:
    """Of the way from the axis, the part inside."""
    return 1.0 if curve(way) <= 0 else float(brentq(lambda u: curve(u * way), 0, 1, xtol=1e-15))


def ellipse(length_to_width: float, mains: int = 8) -> GirdleOutline:
    """The first main at the end."""
    a = length_to_width
    around = [_direction(2 * math.pi * k / mains) for k in range(mains)]
    return outline(
        [(a * c, s) for c, s in around], [(c / a, s) for c, s in around], lambda p: (p[0] / a) ** 2 + p[1] ** 2 - 1
    )


def pillow(length_to_width: float, power: float) -> GirdleOutline:
    """|x/a|^p + |y|^p = 1 (Lame 1818), mains at the ends, the sides and the four corners."""
    a, p = length_to_width, power

    def rounded(c: float, exponent: float) -> float:
        return math.copysign(abs(c) ** exponent, c)

    around = [_direction(math.pi * k / 4) for k in range(8)]
    places = [(rounded(c, 2 / p), rounded(s, 2 / p)) for c, s in around]
    return outline(
        [(a * x, y) for x, y in places],
        [(rounded(x, p - 1) / a, rounded(y, p - 1)) for x, y in places],
        lambda q: abs(q[0] / a) ** p + abs(q[1]) ** p - 1,
    )


def two_arcs(length_to_width: float, mains: int = 10) -> GirdleOutline:
    """Arcs through (+-a, 0) and (0, +-1): their radius is (a^2 + 1) / 2. The tips are corners between two mains."""
    a, per_arc = length_to_width, mains // 2
    radius, half = _arc(a)
    ways = [half * (1 - (2 * k + 1) / per_arc) for k in range(per_arc)]
    places = [(s * x, s * y) for s in (1, -1) for x, y in (_on_arc(radius, way) for way in ways)]
    normals = [(s * math.sin(way), s * math.cos(way)) for s in (1, -1) for way in ways]
    return outline(places, normals, lambda q: math.hypot(q[0], abs(q[1]) + radius - 1) - radius)


def drop(length_to_width: float, round_mains: int = 3, side_mains: int = 2) -> GirdleOutline:
    """Half a circle of radius 1 about the axis, and two arcs that touch it at (0, +-1) and meet in a tip at x = a."""
    a = 2 * length_to_width - 1
    radius, half = _arc(a)
    ways = [half * (1 - (2 * k + 1) / (2 * side_mains)) for k in range(side_mains)]
    side = [(_on_arc(radius, way), (math.sin(way), math.cos(way))) for way in ways]
    around = [_direction(math.pi / 2 + math.pi * (k + 0.5) / round_mains) for k in range(round_mains)]
    mains = [
        *side,
        *((place, place) for place in around),
        *(((x, -y), (c, -s)) for (x, y), (c, s) in reversed(side)),
    ]

    def curve(q: Points) -> float:
        return math.hypot(*q) - 1 if q[0] <= 0 else math.hypot(q[0], abs(q[1]) + radius - 1) - radius

    found = outline([place for place, _ in mains], [normal for _, normal in mains], curve)
    length, width = np.ptp(found.corners, axis=0)  # corners on a curve span a little less than the curve
    return found.stretched(2 * length_to_width / length, 2 / width)


def three_arcs(bulge: float) -> GirdleOutline:
    """A triangle whose sides are arcs of that height over their length; mains at the corners and the sides' middles."""
    side, high = math.sqrt(3), bulge * math.sqrt(3)
    radius = (side**2 / 4 + high**2) / (2 * high)
    far = 0.5 + high  # of a side's middle, where the corners are at 1
    around = [_direction(math.pi * k / 3) for k in range(6)]
    middles = np.array(around[1::2]) * (far - radius)
    found = outline(
        [(c * (far if k % 2 else 1), s * (far if k % 2 else 1)) for k, (c, s) in enumerate(around)],
        around,
        lambda q: float(np.hypot(*(q - middles).T).max()) - radius,
    )
    width = float(np.ptp(found.corners[:, 1]))
    return found.stretched(2 / width, 2 / width)


LOBE_MAINS = (-45, -8, 28, 64, 100, 132, 160, 188)
"""Degrees of the normals at the mains of a heart's right lobe, whose tip is at -90; past 90 is the cleft."""
_LOBE_LENGTH = 1.92
"""Of a lobe before it is stretched, in half widths."""
_BOW = 0.05
"""Height of the bow of a lobe's sides over their length: a straight side would give two mains one support line."""


def lobe(length_to_width: float, arc: float) -> GirdleOutline:
    """The right lobe of a heart of half width 1: a circle of that radius, and two bowed ways from it to the tip at
    x = 0, stretched to that length. The culet, where the axis is, lies 0.47 of the length below the top. MeshError if
    the tip is inside the circle."""
    across = 1 - arc
    tip = np.array([0.0, -0.53 * _LOBE_LENGTH])
    centre = np.array([across, 0.47 * _LOBE_LENGTH - arc])
    way = tip - centre
    if arc >= math.hypot(*way):
        raise MeshError("heart: the arcs of the lobes leave no room for a tip")
    base, half = math.atan2(way[1], way[0]), math.acos(arc / math.hypot(*way))
    turns = np.linspace(base + half, base + 2 * math.pi - half, 2001)
    circle = centre + arc * np.column_stack([np.cos(turns), np.sin(turns)])
    points = np.concatenate([circle, _bowed(circle[-1], tip), tip[None], _bowed(tip, circle[0])])
    points = points[ConvexHull(points).vertices]
    normals = np.column_stack([f(np.radians(LOBE_MAINS)) for f in (np.cos, np.sin)])
    mains = points[(points @ normals.T).argmax(axis=0)]
    edges = np.roll(points, -1, axis=0) - points
    across_edges = np.column_stack([edges[:, 1], -edges[:, 0]])
    distances = np.einsum("ij,ij->i", across_edges, points)
    found = outline(
        [(x, y) for x, y in mains.tolist()],
        [(x, y) for x, y in normals.tolist()],
        lambda q: float((across_edges @ q - distances).max()),
    )
    own = _right_half(found.corners)
    return found.stretched(1 / float(own[:, 0].max()), 2 * length_to_width / float(np.ptp(own[:, 1])))


def _right_half(polygon: Points) -> Points:
    """The corners at x >= 0, and where sides cross x = 0."""
    after = np.roll(polygon, -1, axis=0)
    crossing = polygon[:, 0] * after[:, 0] < 0
    a, b = polygon[crossing], after[crossing]
    part = a[:, :1] / (a[:, :1] - b[:, :1])
    return np.concatenate([polygon[polygon[:, 0] >= 0], a + part * (b - a)])


def _bowed(a: Points, b: Points) -> Points:
    u = np.linspace(0, 1, 400)[1:-1, None]
    along = b - a
    return np.asarray(a + u * along + 4 * _BOW * u * (1 - u) * np.array([along[1], -along[0]]))


def _direction(azimuth: float) -> tuple[float, float]:
    """Cosine and sine, of which those on the axes are exact: a pillow's powers make much of the smallest."""
    cosine, sine = math.cos(azimuth), math.sin(azimuth)
    return (0.0 if abs(cosine) < 1e-12 else cosine), (0.0 if abs(sine) < 1e-12 else sine)


def _arc(a: float) -> tuple[float, float]:
    """Radius of an arc through (+-a, 0) and (0, 1), and the angle between its normal at the end and y."""
    radius = (a * a + 1) / 2
    return radius, math.asin(min(1.0, a / radius))


def _on_arc(radius: float, way: float) -> tuple[float, float]:
    return radius * math.sin(way), radius * math.cos(way) - (radius - 1)
