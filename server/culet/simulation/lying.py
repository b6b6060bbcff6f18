"""How a stone of another shape takes the place of one that was on the floor: neither above the floor nor through it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from culet.geometry.shape import Shape
from culet.scene.cuts import proportions
from culet.scene.fields import Pose
from culet.scene.room import FLOOR_Y
from culet.scene.stone import StoneSettings
from culet.simulation.one_stone.drop import STANDING
from culet.simulation.rigid_body.rotation import normalised, product, rotate, rotate_back
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.stage import Stage

LYING_DEGREES = 10.0
"""A stone was meant to lie on a facet that is level to this. The default stone's is by 5.4 degrees: its pose was drawn
for its light. A stone that is tilted further was set on a corner on purpose."""
LEVEL_DEGREES = 0.01
"""A facet is level to this, and need not be turned."""
DOWN: Triple = (0.0, -1.0, 0.0)

Array = NDArray[np.float64]


def put_down(stage: Stage, before: Stage) -> Stage:
    """The stage with each stone `on_the_floor` that has another shape or scale than before, and the same pose."""
    known = {stone.id: (stone, shape) for stone, shape in zip(before.scene.stones, before.shapes, strict=True)}
    poses = []
    for stone, shape in zip(stage.scene.stones, stage.shapes, strict=True):
        old, old_shape = known.get(stone.id, (stone, shape))
        stayed = (stone.position, stone.orientation) == (old.position, old.orientation)
        other = shape is not old_shape or stone.scale != old.scale
        put = stayed and other
        poses.append(on_the_floor(stone, shape, old, old_shape) if put else (stone.position, stone.orientation))
    return stage.posed(poses)


def on_the_floor(stone: StoneSettings, shape: Shape, old: StoneSettings, old_shape: Shape) -> Pose:
    """The pose of a stone of that shape and scale which stands as the old one stood in its place.

    It touches the floor. What lay on a facet lies on one: the new shape is turned as little as it can be, and not at
    all if it is the same cut or design in other proportions, whose facet is about level. What stood on a corner or an
    edge is not turned. What was in the air, or deep in the floor, stays.
    """
    position, orientation = stone.position, stone.orientation
    if abs(position[1] - resting_height(old_shape, orientation, old.scale)) > STANDING:
        return position, orientation
    facet = lowest_facet(shape, orientation)
    lay = slope_degrees(orientation, lowest_facet(old_shape, orientation)) <= LYING_DEGREES
    slope = LYING_DEGREES if _is_recut(stone, old) else LEVEL_DEGREES
    if lay and slope_degrees(orientation, facet) > slope:
        orientation = laid(orientation, facet)
    x, _, z = position
    return (x, resting_height(shape, orientation, stone.scale), z), orientation


def _is_recut(stone: StoneSettings, old: StoneSettings) -> bool:
    """Whether the stone is the old one in other proportions: it would jump under a slider if it were turned."""
    if stone.mesh is not None or old.mesh is not None:
        return stone.mesh == old.mesh
    return proportions(stone.cut).name == proportions(old.cut).name


def resting_height(shape: Shape, orientation: Quaternion, scale: float = 1.0) -> float:
    """y of the centre of a stone whose lowest corner touches the floor, R."""
    return FLOOR_Y - scale * float((shape.vertices @ np.array(rotate_back(orientation, (0.0, 1.0, 0.0)))).min())


def lowest_facet(shape: Shape, orientation: Quaternion) -> Triple:
    """Outward normal, in the stone's axes, of the facet that it could lie on and that points down the most."""
    x, y, z = rotate_back(orientation, DOWN)
    normals = resting_facets(shape.vertices)
    a, b, c = normals[(normals @ np.array([x, y, z])).argmax()].tolist()
    return (a, b, c)


def resting_facets(vertices: Array) -> Array:
    """(F, 3) outward unit normals of those facets of the convex hull that have the origin, the centre of mass, above
    themselves: a body lies on these alone."""
    hull = ConvexHull(vertices)
    normals, foot = hull.equations[:, :3], -hull.equations[:, :3] * hull.equations[:, 3:]
    corners = vertices[hull.simplices]
    middle = corners.mean(axis=1)
    above = np.ones(len(normals), bool)
    for k in range(3):  # the foot of the centre is on the middle's side of each edge
        along = corners[:, (k + 1) % 3] - corners[:, k]
        inward = np.cross(normals, along)
        inward *= np.sign((inward * (middle - corners[:, k])).sum(axis=1, keepdims=True))
        length = np.maximum(np.linalg.norm(inward, axis=1), 1e-30)
        above &= (inward * (foot - corners[:, k])).sum(axis=1) > -1e-9 * length
    # The nearest facet always holds; roundings may let it miss.
    above[hull.equations[:, 3].argmax()] = True
    return np.asarray(normals[above])


def laid(orientation: Quaternion, facet: Triple) -> Quaternion:
    """The orientation after the smallest turn that lets a facet of that outward normal (stone's axes) point down."""
    a, b, c = rotate(orientation, facet)
    if b > 1 - 1e-9:  # it points up: any half turn about a level axis will do
        return product((0.0, 1.0, 0.0, 0.0), orientation)
    # Half-way quaternion (1 + u . v, u x v) of u = facet and v = down
    return normalised(product((1.0 - b, c, 0.0, -a), orientation))


def slope_degrees(orientation: Quaternion, facet: Triple) -> float:
    """Between a facet of that outward normal (stone's axes) and the floor below it."""
    _, b, _ = rotate(orientation, facet)
    return math.degrees(math.acos(max(-1.0, min(1.0, -b))))
