"""Whether a stone at rest would stay there."""

from __future__ import annotations

from collections.abc import Sequence

from culet.simulation.one_stone.contact import Contact

MARGIN = 1e-4
"""R. With its centre of mass nearer than this to the edge of what carries it, a stone is balancing: it stays awake."""


def is_supported(points: Sequence[Contact]) -> bool:
    """Whether the centre of mass is above the polygon that the floor's contacts span, by MARGIN.

    The centre of mass is the origin of the contacts' arms. The polygon holds it just if no vertical plane through it
    has all contacts on one side: going round by angle, no two neighbours are half a turn apart or more.
    """
    feet = [(point.arm[0], point.arm[2]) for point in points if point.normal[1] == 1]
    if len(feet) < 3:
        return False
    corners = _convex_polygon(feet)
    if len(corners) < 3:
        return False
    for (ax, az), (bx, bz) in zip(corners, corners[1:] + corners[:1], strict=True):
        edge_x, edge_z = bx - ax, bz - az
        if ax * edge_z - az * edge_x < MARGIN * (edge_x * edge_x + edge_z * edge_z) ** 0.5:
            return False
    return True


def _convex_polygon(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Counter-clockwise corners, by Andrew's monotone chain."""
    ordered = sorted(set(points))

    def chain(sequence: list[tuple[float, float]]) -> list[tuple[float, float]]:
        corners: list[tuple[float, float]] = []
        for x, z in sequence:
            while len(corners) > 1:
                (ax, az), (bx, bz) = corners[-2:]
                if (bx - ax) * (z - az) - (bz - az) * (x - ax) > 0:
                    break
                corners.pop()
            corners.append((x, z))
        return corners[:-1]

    return chain(ordered) + chain(ordered[::-1])
