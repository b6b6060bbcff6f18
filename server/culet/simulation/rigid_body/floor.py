"""The floor, and the sphere about the stone, as the simulation sees them."""

from __future__ import annotations

from culet.scene.room import FLOOR_Y
from culet.simulation.rigid_body.state import Triple

BOUNDING_RADIUS = 1.0
"""R: a stone's farthest vertex is at distance 1 from its centre."""


def sphere_gap(position: Triple) -> float:
    """Distance from the bounding sphere down to the floor, R; negative where the sphere reaches below it."""
    return position[1] - BOUNDING_RADIUS - FLOOR_Y
