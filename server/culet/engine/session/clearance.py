"""Keeping the camera out of the stones: a move ends before the stone that it would enter.

A stone that fell over the camera, or that a scene has about its camera, hinders no move: the camera may leave it.
Cameras of parallel rays are in no stone, since their rays come from infinitely far.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from culet.engine.session.picking import Placed, spans_inside
from culet.scene import Camera, Vector

CLEARANCE = 0.05
"""R, along the way of the camera, that are left before a stone. A facet of a brilliant fills the picture from there;
nearer by far, and single precision would show."""

Array = NDArray[np.float64]


def stopped(before: Camera, after: Camera, stones: Iterable[Placed]) -> Camera:
    """The camera as far on a straight way from `before` to `after` as no stone is in that way; its target moves by as
    much as of its own way is left."""
    start, end = np.array(before.position, float), np.array(after.position, float)
    length = float(np.linalg.norm(end - start))
    if before.kind != "pinhole" or length == 0:
        return after
    way, free = (end - start) / length, length
    for stone in stones:
        if _gap(start, stone) > length + CLEARANCE:
            continue
        ahead = [enter for enter, _ in spans_inside(start, way, stone) if enter >= 0]
        free = min(free, max(min(ahead, default=math.inf) - CLEARANCE, 0.0))
    if free == length:
        return after
    part = free / length
    target, moved = np.array(before.target, float), np.array(after.target, float)
    return _placed(after, start + free * way, target + part * (moved - target))


def stepped_back(before: Camera, after: Camera, stones: Iterable[Placed]) -> Camera:
    """The camera so far from its target, in the direction in which `after` is, that it is in none of the stones."""
    if after.kind != "pinhole":
        return after
    target, offset = np.array(after.target, float), np.array(after.position, float) - np.array(after.target, float)
    distance = float(np.linalg.norm(offset))
    out, was = offset / distance, np.array(before.position, float)
    known, place, blocked = tuple(stones), distance, True
    while blocked:
        near = [stone for stone in known if _gap(target + place * out, stone) < CLEARANCE and not is_inside(was, stone)]
        spans = (span for stone in near for span in spans_inside(target, out, stone))
        ends = [leave + CLEARANCE for enter, leave in spans if enter - CLEARANCE < place < leave + CLEARANCE]
        blocked, place = bool(ends), max(ends, default=place)
    return after if place == distance else _placed(after, target + place * out, target)


def entered(before: Vector, after: Vector, stones: Iterable[Placed]) -> str | None:
    """The id of the stone that is about the second of two places, and was not about the first; None if none is."""
    start, end = np.array(before, float), np.array(after, float)
    return next((stone.name for stone in stones if is_inside(end, stone) and not is_inside(start, stone)), None)


def is_inside(point: Array, stone: Placed) -> bool:
    """Whether a point of the world is in a stone."""
    if _gap(point, stone) > 0:
        return False
    # Any line will do; this one is along no edge of a stone that stands straight.
    way = np.array([0.48, 0.6, 0.64])
    return any(enter < 0 < leave for enter, leave in spans_inside(point, way, stone))


def _gap(point: Array, stone: Placed) -> float:
    """R from a point to the ball about a stone; negative inside."""
    return math.dist(point, stone.position) - stone.scale


def _placed(camera: Camera, position: Array, target: Array) -> Camera:
    place = {"position": position.tolist(), "target": target.tolist()}
    return Camera.model_validate({**camera.model_dump(), **place})
