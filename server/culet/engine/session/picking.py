"""Which stone is under a point of the picture, and where the line of sight strikes that stone."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from culet.engine.session.viewpoint import axes, half_height
from culet.geometry.shape import Shape
from culet.scene import Camera, Vector
from culet.simulation.rigid_body.rotation import rotate, rotate_back
from culet.simulation.rigid_body.state import Quaternion, Triple
from culet.stage import Stage

Array = NDArray[np.float64]


NEARLY = 1e-9
"""Of a stone's radius: a corner so near to the line of sight counts as being on either side."""


class Placed(NamedTuple):
    """A stone where it is."""

    name: str
    """The stone's id."""
    shape: Shape
    scale: float
    """R: the radius of the ball about the stone."""
    position: Vector
    """R."""
    orientation: Quaternion


class Struck(NamedTuple):
    """What a line of sight meets first."""

    name: str
    """The stone's id."""
    point: Triple
    """R, in the world."""


def placed(stage: Stage) -> list[Placed]:
    """The stones of a stage where its scene has them."""
    return [
        Placed(stone.id, shape, stone.scale, stone.position, stone.orientation)
        for stone, shape in zip(stage.scene.stones, stage.shapes, strict=True)
    ]


def corners(stone: Placed) -> Array:
    """(V, 3) corners of a stone in the world, R."""
    turn = np.array([rotate(stone.orientation, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))])
    turned: Array = stone.shape.vertices @ turn
    found: Array = stone.scale * turned + np.array(stone.position, float)
    return found


def struck(camera: Camera, stones: Iterable[Placed], x: float, y: float) -> Struck | None:
    """The stone whose surface the line of sight through a point of the picture enters first; None if there is none.

    x to the right and y up, from the picture's centre, in halves of its height. A stone that the camera is inside of is
    not struck.
    """
    eye, sight = _line_of_sight(camera, x, y)
    behind = 0.0 if camera.kind == "pinhole" else -math.inf  # parallel rays come from infinitely far
    nearest, found = math.inf, None
    for stone in stones:
        distance = _distance(eye, sight, stone, behind)
        if behind < distance < nearest:
            nearest, found = distance, stone.name
    if found is None:
        return None
    hit = eye + nearest * sight
    return Struck(found, (float(hit[0]), float(hit[1]), float(hit[2])))


def spans_inside(eye: Array, way: Array, stone: Placed) -> list[tuple[float, float]]:
    """Where a line through `eye` along `way` (of length 1) is in a stone: R from the eye to where it enters and leaves,
    negative behind the eye. One span of a convex stone, and any number of another."""
    offset = eye - np.array(stone.position, float)
    along = float(offset @ way)
    if float(offset @ offset) - along * along > stone.scale**2:  # the line passes by the ball about the stone
        return []
    start, turned = (np.array(rotate_back(stone.orientation, (v[0], v[1], v[2]))) for v in (offset / stone.scale, way))
    shape = stone.shape
    if shape.convex:
        enter, leave = _through_planes(start, turned, shape.planes)
        spans = [(enter, leave)] if enter < leave else []
    else:
        spans = _through_triangles(start, turned, shape)
    return [(enter * stone.scale, leave * stone.scale) for enter, leave in spans]


def _line_of_sight(camera: Camera, x: float, y: float) -> tuple[Array, Array]:
    """A point of it (R), and its direction (of length 1), both in the world."""
    right, up, forward = axes(camera)
    eye, half = np.array(camera.position, float), half_height(camera)
    if camera.kind == "orthographic":
        return eye + half * (x * right + y * up), forward
    sight = forward + half * (x * right + y * up)
    return eye, sight / np.linalg.norm(sight)


def _distance(eye: Array, sight: Array, stone: Placed, behind: float) -> float:
    """R along the line to where it enters the stone beyond `behind`; infinite if the line passes by."""
    offset = eye - np.array(stone.position, float)
    along = float(offset @ sight)
    if float(offset @ offset) - along * along > stone.scale**2:  # the line passes by the ball about the stone
        return math.inf
    start, way = (np.array(rotate_back(stone.orientation, (v[0], v[1], v[2]))) for v in (offset / stone.scale, sight))
    shape = stone.shape
    if shape.convex:
        enter, leave = _through_planes(start, way, shape.planes)
        return math.inf if enter > leave else enter * stone.scale
    distances, entering = _at_triangles(start, way, shape)
    return float(distances[entering & (distances > behind)].min(initial=math.inf)) * stone.scale


def _through_planes(start: Array, way: Array, planes: Array) -> tuple[float, float]:
    """Along a line to where it enters and leaves the intersection of half-spaces, which the line misses if it leaves
    before it enters; the slab method (Kay and Kajiya 1986)."""
    towards, room = planes[:, :3] @ way, planes[:, 3] - planes[:, :3] @ start
    if (room[towards == 0] < 0).any():
        return math.inf, -math.inf
    crossings, entering = room[towards != 0] / towards[towards != 0], towards[towards != 0] < 0
    return float(crossings[entering].max(initial=-math.inf)), float(crossings[~entering].min(initial=math.inf))


def _through_triangles(start: Array, way: Array, shape: Shape) -> list[tuple[float, float]]:
    """The spans of a line that are in a closed surface: each from a triangle met from outside to the next one met from
    inside."""
    distances, entering = _at_triangles(start, way, shape)
    spans: list[tuple[float, float]] = []
    since: float | None = None
    for distance, enters in sorted(zip(distances.tolist(), entering.tolist(), strict=True)):
        if enters and since is None:
            since = distance
        elif not enters and since is not None:
            spans.append((since, distance))
            since = None
    return spans


def _at_triangles(start: Array, way: Array, shape: Shape) -> tuple[Array, NDArray[np.bool_]]:
    """Along a line to each triangle that it meets (Moeller and Trumbore 1997), and whether it meets it from outside; a
    line through an edge meets the triangles on both of its sides."""
    corners = shape.vertices[shape.triangles[_about(start, way, shape)]]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(way, second)
    facing = np.einsum("ij,ij->i", first, across)
    crossed = facing != 0
    first, second, across, facing = first[crossed], second[crossed], across[crossed], facing[crossed]
    offset = start - corners[crossed, 0]
    u = np.einsum("ij,ij->i", offset, across) / facing
    beside = np.cross(offset, first)
    v = beside @ way / facing
    distances = np.einsum("ij,ij->i", second, beside) / facing
    met = (u >= 0) & (v >= 0) & (u + v <= 1)
    return distances[met], facing[met] > 0


def _about(start: Array, way: Array, shape: Shape) -> NDArray[np.bool_]:
    """(T,) whether a triangle may meet the line: not if all of it is on one side of a plane through the line."""
    across = np.cross(way, np.eye(3)[np.abs(way).argmin()])
    across /= np.linalg.norm(across)
    about = np.ones(len(shape.triangles), bool)
    for normal in (across, np.cross(way, across)):
        height = (shape.vertices - start) @ normal
        for outside in (height > NEARLY, height < -NEARLY):
            about &= ~outside[shape.triangles].all(axis=1)
    return about
