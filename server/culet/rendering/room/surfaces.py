"""Floor and walls as planes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, WALL_DISTANCE, WALL_NORMALS

Array = NDArray[np.float64]


def room_surfaces(centre: Array) -> Array:
    """(4, 4) floor and walls as inward normal and offset, relative to a place."""
    normals = np.array([(0, 1, 0), *WALL_NORMALS], dtype=float)
    offsets = np.array([FLOOR_Y, *[-WALL_DISTANCE] * 3]) - normals @ centre
    return np.column_stack([normals, offsets])


def shown(scene: Scene) -> tuple[int, ...]:
    """Numbers of those surfaces that the scene has: 0 the floor, 1 to 3 the walls."""
    floor = () if scene.floor.kind == "none" else (0,)
    return floor if scene.walls.kind == "none" else (*floor, 1, 2, 3)


def shown_surfaces(scene: Scene, centre: Array) -> Array:
    """(S, 4) those surfaces, relative to a place."""
    return room_surfaces(centre)[list(shown(scene))]
