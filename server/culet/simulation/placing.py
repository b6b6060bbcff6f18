"""Moving a stone by hand: to where it is free, neither in the floor or a wall nor in another stone."""

from __future__ import annotations

import math
from dataclasses import replace

from culet.scene.fields import Pose
from culet.simulation.bodies import BodyState
from culet.simulation.lying import resting_height
from culet.simulation.one_stone.drop import STANDING
from culet.simulation.rigid_body.hull import hull_of
from culet.simulation.rigid_body.rotation import normalised, product, rotate_back
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.simulation.together import Together
from culet.simulation.world import World

ROUNDS = 16
"""Each moves the stone out of everything that it is in, one thing after the other. A wall and the floor take one, a gap
between stones that the stone fits into a few; one that it does not fit into takes all, and is refused."""
PUSHES = 4
"""Out of stones, in each round: the next round goes on. A place among 64 stones that has no room is given up after a
tenth of the time that a push for each of them takes."""
OVERLAP = 1e-4
"""R, that stones may overlap where they are put; those that the solver has brought to rest do by up to 7e-5 R."""
PARTS = (1.0, 0.5, 0.25, 0.125)
"""Of a move. What leaves no room for all of it may leave room for a part."""


def moved_by_hand(world: World, name: str, shift: Triple, turn: Triple) -> Pose | None:
    """Where a stone of the world comes to be that a hand moves by `shift` (R) and turns about its centre by `turn` (a
    vector along the axis, as long as the angle in radians); None if there is room for no part of that.

    What is in the way stays, and pushes the stone aside: it slides along the floor and along others. A stone that
    stands on the floor, and is turned only, stands on the floor. InputError without that stone.
    """
    number = world.number(name)
    body, now = world.bodies[number], world.state.bodies[number]
    stands = abs(now.position[1] - resting_height(body.shape, now.orientation, body.scale)) <= STANDING
    room = _Room(world, number)
    for part in PARTS:
        a, b, c = (part * angle for angle in turn)
        x, y, z = (place + part * way for place, way in zip(now.position, shift, strict=True))
        orientation = _turned(now.orientation, (a, b, c))
        if stands and not any(shift):
            y = resting_height(body.shape, orientation, body.scale)
        position = room.free((x, y, z), orientation)
        if position is not None:
            return position, orientation
    return None


class _Room:
    """What is about a stone that is moved."""

    def __init__(self, world: World, number: int) -> None:
        self._body, self._surfaces = world.bodies[number], world.surfaces
        placed = [
            replace(body, position=state.position, orientation=state.orientation)
            for body, state in zip(world.bodies, world.state.bodies, strict=True)
        ]
        self._others = [body for body in placed if body.name != self._body.name]
        self._pairs = Together(world.law, placed, ()) if self._others else None

    def free(self, position: Triple, orientation: Quaternion) -> Triple | None:
        """The place near this one where the stone is free; None if none was found."""
        for _ in range(ROUNDS):
            position = self._out_of_surfaces(self._out_of_stones(position, orientation), orientation)
            overlaps = [depth for depth, _ in self._overlaps(position, orientation)]
            if max(overlaps, default=0.0) <= OVERLAP and self._above_surfaces(position, orientation):
                return position
        return None

    def _overlaps(self, position: Triple, orientation: Quaternion) -> list[tuple[float, Triple]]:
        """With each stone that the moved one overlaps at a place: how deep, R, and which way is out."""
        if self._pairs is None:
            return []
        self._pairs.set_state(self._body, BodyState(position, orientation, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
        found = [
            self._pairs.separation(other.name, self._body.name, 0.0)
            for other in self._others
            if math.dist(other.position, position) < other.scale + self._body.scale
        ]
        return [(-distance, axis) for distance, axis in found if distance < 0]

    def _out_of_stones(self, position: Triple, orientation: Quaternion) -> Triple:
        """Out of the stone that it is in most, then out of what it is in then, and so on."""
        for _ in range(PUSHES if self._others else 0):
            depth, axis = max(self._overlaps(position, orientation), default=(0.0, (0.0, 0.0, 0.0)))
            if depth <= OVERLAP:
                break
            position = _along(position, axis, depth)
        return position

    def _out_of_surfaces(self, position: Triple, orientation: Quaternion) -> Triple:
        for normal, offset in self._surfaces:
            position = _along(position, normal, max(offset - self._lowest(position, orientation, normal), 0.0))
        return position

    def _above_surfaces(self, position: Triple, orientation: Quaternion) -> bool:
        return all(self._lowest(position, orientation, normal) >= offset - OVERLAP for normal, offset in self._surfaces)

    def _lowest(self, position: Triple, orientation: Quaternion, normal: Triple) -> float:
        """Of the stone along a direction of the world, R."""
        corners = hull_of(self._body.shape).heights(rotate_back(orientation, normal))
        return sum(p * n for p, n in zip(position, normal, strict=True)) + self._body.scale * float(corners.min())


def _along(position: Triple, way: Triple, distance: float) -> Triple:
    x, y, z = (place + distance * step for place, step in zip(position, way, strict=True))
    return x, y, z


def _turned(orientation: Quaternion, turn: Triple) -> Quaternion:
    angle = math.hypot(*turn)
    if angle == 0:
        return orientation
    x, y, z = (math.sin(angle / 2) / angle * component for component in turn)
    return normalised(product((math.cos(angle / 2), x, y, z), orientation))
