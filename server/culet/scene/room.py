"""The room about the stone: a floor and three walls, for the renderer and the simulation alike."""

from __future__ import annotations

import math

FLOOR_Y = -1.0
"""Height of the floor, R."""
WALL_DISTANCE = 8.0
"""Of the walls from the world's origin, R."""
WALL_NORMALS = ((0.0, 0.0, 1.0), (math.sqrt(0.75), 0.0, 0.5), (-math.sqrt(0.75), 0.0, 0.5))
"""Inward: a hexagon's three far sides."""
