"""The stones of a picture: what each is made of, its shape, its size and its place, in double precision."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple
from weakref import ReferenceType, ref

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.scene.model import Scene
from culet.scene.stone import StoneSettings
from culet.stage import Stage

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlacedStone:
    """One stone. Its own measure: relative to its centre, in the world's axes, in units of its radius."""

    settings: StoneSettings
    shape: Shape
    number: int
    """Of the stone in the scene."""
    centre: Array
    """(3,), in the world, R."""
    rotation: Array
    """(3, 3), its own axes in the world's as columns."""
    scale: float
    """Its radius, R."""

    @property
    def planes(self) -> Array:
        """(F, 4) facets in its own measure."""
        return np.column_stack([self.shape.planes[:, :3] @ self.rotation.T, self.shape.planes[:, 3]])

    @property
    def vertices(self) -> Array:
        """(V, 3), in its own measure."""
        return np.asarray(self.shape.vertices @ self.rotation.T)

    def own(self, point: Iterable[float]) -> Array:
        """A point of the world in the stone's own measure."""
        return (np.array(tuple(point), dtype=float) - self.centre) / self.scale

    def depth(self, point: Iterable[float]) -> float:
        """How far inside the stone a point of the world is, in its radii; not positive outside. Of a stone that is not
        convex all points inside are as deep as can be."""
        point = tuple(point)
        if math.dist(self.settings.position, point) >= self.scale:
            return 0.0
        own = self.own(point) @ self.rotation
        if own @ own >= 1:
            return 0.0
        if self.shape.convex:
            return float((self.shape.planes[:, 3] - self.shape.planes[:, :3] @ own).min())
        return float(abs(_winding_number(self.shape, own)) > 0.5)


def rotation_matrix(orientation: tuple[float, float, float, float]) -> Array:
    """(3, 3), the stone's axes in the world as columns, from a unit quaternion w, x, y, z."""
    return np.asarray(_rotations(np.array([orientation]))[0])


def _rotations(orientations: Array) -> Array:
    """(N, 3, 3) of N quaternions."""
    w, x, y, z = orientations.T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


@dataclass(frozen=True, eq=False)
class _Placed:
    """The stones of the stage that was asked for last: a picture's features, parameters and table ask for the same."""

    stage: ReferenceType[Stage]
    stones: tuple[PlacedStone, ...]


_latest: list[_Placed] = []


def placed_stones(stage: Stage) -> tuple[PlacedStone, ...]:
    """The stage's stones, ordered by place: how the scene orders them changes nothing, to the bit."""
    for latest in _latest:
        if latest.stage() is stage:
            return latest.stones
    settings = stage.scene.stones
    if not settings:
        return ()
    centres = np.array([stone.position for stone in settings], dtype=float)
    rotations = _rotations(np.array([stone.orientation for stone in settings], dtype=float))
    stones = tuple(
        PlacedStone(settings[number], stage.shapes[number], number, centres[number], rotations[number], place.scale)
        for place, number in sorted(_places(stage), key=lambda each: each[0])
    )
    _latest[:] = [_Placed(ref(stage), stones)]
    return stones


class _Place(NamedTuple):
    """By which stones are ordered."""

    position: tuple[float, ...]
    scale: float
    orientation: tuple[float, ...]
    facets: int
    material: str
    """Of stones that share their position; which takes longer to tell than all else."""


def _places(stage: Stage) -> list[tuple[_Place, int]]:
    stones = stage.scene.stones
    shared = {position for position, count in Counter(stone.position for stone in stones).items() if count > 1}
    return [
        (
            _Place(
                stone.position, stone.scale, stone.orientation, len(shape.planes),
                repr(stone.material) if stone.position in shared else "",
            ),
            number,
        )
        for number, (stone, shape) in enumerate(zip(stones, stage.shapes, strict=True))
    ]  # fmt: skip


def origin_of(scene: Scene, stones: Sequence[PlacedStone]) -> Array:
    """(3,) the origin of the kernels' frame, in the world, about which positions are told most exactly: the middle of
    the stones, above all of those at the camera's target. That is the centre of one stone, and the world's origin where
    there is none."""
    if not stones:
        return np.zeros(3)
    if len(stones) == 1:
        return stones[0].centre
    centres, scales = centres_of(stones), np.array([stone.scale for stone in stones])
    weights = (scales / (scales + np.linalg.norm(centres - scene.camera.target, axis=1))) ** 4
    total = math.fsum(weights.tolist())
    return np.array([math.fsum(column) / total for column in (weights[:, None] * centres).T.tolist()])


def centres_of(stones: Sequence[PlacedStone]) -> Array:
    """(N, 3), in the world, R."""
    return np.array([stone.centre for stone in stones]).reshape(-1, 3)


def by_shape(stones: Sequence[PlacedStone]) -> dict[Shape, list[int]]:
    """The stones' numbers: what is made of a shape is made once."""
    numbers: dict[Shape, list[int]] = {}
    for number, stone in enumerate(stones):
        numbers.setdefault(stone.shape, []).append(number)
    return numbers


def extent_of(stones: Sequence[PlacedStone], origin: Array) -> float:
    """R from a place within which all stones are."""
    away = np.linalg.norm(centres_of(stones) - origin, axis=1) + [stone.scale for stone in stones]
    return float(away.max(initial=0))


def camera_stone(scene: Scene, stones: Sequence[PlacedStone]) -> int | None:
    """Which of the stones holds the eye: the one in which it is deepest. On a surface counts as outside. Parallel rays
    begin outside."""
    if scene.camera.kind == "orthographic" or not stones:
        return None
    eye = scene.camera.position
    near = [number for number, stone in enumerate(stones) if math.dist(stone.settings.position, eye) < stone.scale]
    depths = {number: stones[number].depth(eye) * stones[number].scale for number in near}
    deepest = max(depths, key=depths.__getitem__, default=None)
    return deepest if deepest is not None and depths[deepest] > 0 else None


def _winding_number(shape: Shape, point: Array) -> float:
    """How often the surface encloses a point: the sum of the triangles' solid angles over 4 pi (Van Oosterom &
    Strackee, IEEE Trans. Biomed. Eng. 30, 125 (1983), eq. 8)."""
    a, b, c = (shape.vertices[shape.triangles[:, k]] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(2 * np.arctan2(triple, dots).sum() / (4 * np.pi))
