"""The planes that stop a stone: the floor always, the walls when they are shown."""

from __future__ import annotations

from typing import NamedTuple

from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, WALL_DISTANCE, WALL_NORMALS
from culet.simulation.rigid_body.state import Triple


class Surface(NamedTuple):
    """A plane that cannot move; the stone stays where normal . x >= offset."""

    normal: Triple
    """Unit, towards the stone."""
    offset: float
    """R."""


FLOOR = Surface((0.0, 1.0, 0.0), FLOOR_Y)
WALLS = tuple(Surface(normal, -WALL_DISTANCE) for normal in WALL_NORMALS)


def surfaces_of(scene: Scene) -> tuple[Surface, ...]:
    """A floor that is not shown carries the stone nevertheless: it would fall for ever."""
    return (FLOOR, *WALLS) if scene.walls.kind != "none" else (FLOOR,)
