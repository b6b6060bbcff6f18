"""The facets that a cut is meant to have, and the shape that has these facets and no others.

The frame here is the cutters': z is up, the girdle's middle is at z = 0, the length lies along x, and half the width
is 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from culet.errors import MeshError
from culet.geometry.half_spaces import Intersection, intersection
from culet.geometry.shape import FacetName, Shape

Point = NDArray[np.float64]
"""(3,)"""
Points = NDArray[np.float64]

SAME_TIER = 1e-9
"""Of angle (radians) and distance, between facets of one tier; rounding leaves 1e-15."""
MISSED = 1e-7
"""By how much a corner may lie elsewhere than it was meant to, in half widths. Planes that meet flatly shift a corner
by some 1e-16 over their angle; a corner that others cut off is gone by about as much as its shortest edge."""
SAME_POINT = 1e-9
"""Corners that were meant to be one, in half widths."""


def at(xy: Sequence[float] | Point, z: float) -> Point:
    """The point over (x, y) at height z."""
    return np.array([xy[0], xy[1], z], np.float64)


def turned(radius: float, azimuth: float, z: float) -> Point:
    """The point at that distance from the axis; radians, counter-clockwise seen from above."""
    return np.array([radius * np.cos(azimuth), radius * np.sin(azimuth), z])


class Facets:
    """The facets of a convex cut as they are added, from the table down."""

    def __init__(self, name: str) -> None:
        """None so far."""
        self.name = name
        self._names: list[str] = []
        self._planes: list[NDArray[np.float64]] = []
        self._meant: list[Points] = []
        self.corners = 0
        """That are meant, where facets are given as planes."""

    def add(self, name: str, *corners: Point) -> None:
        """A facet by its corners, counter-clockwise seen from outside. Repeated ones count once; a facet of which less
        than three are left, or of no area, is none."""
        points = np.array(corners)
        after = np.roll(points, -1, axis=0)
        points = points[np.abs(points - after).max(axis=1) > SAME_POINT]
        if len(points) < 3:
            return
        # Newell's normal, of all corners: steadier than three of them.
        after = np.roll(points, -1, axis=0)
        area = np.cross(points - points[0], after - points[0]).sum(axis=0)
        size = float(np.linalg.norm(area))
        if size < SAME_POINT**2:
            return
        normal = area / size
        self.add_plane(name, normal, float((points @ normal).mean()))
        self._meant.append(points)

    def add_plane(self, name: str, normal: Point, distance: float) -> None:
        """A facet by its outward unit normal and its distance."""
        self._names.append(name)
        self._planes.append(np.array([*normal, distance]))

    def intersection(self) -> Intersection:
        """The solid; MeshError if a facet or a corner that was meant is not there, or another is."""
        planes = np.array(self._planes)
        found = intersection(self.name, planes)
        gone = sorted(set(range(len(planes))) - set(found.used))
        if gone:
            names = list(dict.fromkeys(self._names[k] for k in gone))
            raise MeshError(f"{self.name}: {len(gone)} facets have no room: {', '.join(names)}")
        if self._meant:
            apart, nearest = KDTree(found.vertices).query(np.concatenate(self._meant))
            if apart.max() > MISSED or len(set(nearest.tolist())) != len(found.vertices):
                names = list(dict.fromkeys(self._names[k] for k in self._shifted(found)))
                raise MeshError(f"{self.name}: facets do not meet as they are meant to: {', '.join(names)}")
        elif len(found.vertices) != self.corners:
            raise MeshError(f"{self.name}: expected {self.corners} corners, got {len(found.vertices)}")
        return found

    def _shifted(self, found: Intersection) -> list[int]:
        """Facets whose corners are not those that were meant."""
        return [
            k
            for k, (meant, polygon) in enumerate(zip(self._meant, found.polygons, strict=True))
            if len(meant) != len(polygon) or KDTree(found.vertices[polygon]).query(meant)[0].max() > MISSED
        ]

    def names(self) -> list[FacetName]:
        """Of each facet, with its tier: facets of one name, angle and distance."""
        numbers: dict[str, list[tuple[float, float]]] = {name: [] for name in self._names}
        places = [(float(np.arctan2(np.hypot(*plane[:2]), plane[2])), float(plane[3])) for plane in self._planes]
        own = [_place(numbers[name], place) for name, place in zip(self._names, places, strict=True)]
        first = dict(zip(numbers, np.cumsum([1, *map(len, numbers.values())]).tolist(), strict=False))
        return [FacetName(first[name] + k, name) for name, k in zip(self._names, own, strict=True)]

    def shape(self) -> Shape:
        """The shape, its table up and its length along x."""
        return turned_up(self.intersection()).shape(self.name, (), self.names())


def turned_up(solid: Intersection) -> Intersection:
    """The solid with y up in place of z."""
    x, y, z, distance = solid.planes.T
    corners = solid.vertices
    return Intersection(
        np.column_stack([x, z, -y, distance]),
        np.column_stack([corners[:, 0], corners[:, 2], -corners[:, 1]]),
        solid.polygons,
    )


def _place(known: list[tuple[float, float]], place: tuple[float, float]) -> int:
    """The place's number among those that are known, to which it is added if it is new."""
    for number in count():
        if number == len(known):
            known.append(place)
        if max(abs(known[number][0] - place[0]), abs(known[number][1] - place[1])) < SAME_TIER:
            return number
    raise AssertionError
