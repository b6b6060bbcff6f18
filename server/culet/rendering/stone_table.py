"""The table of stones as the kernels read it: `stone_t` of parameters.cl, and what its rows point into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from culet.geometry.polygons import edges_of_facets
from culet.geometry.shape import Shape
from culet.rendering.chains import absorption, chains_of_stones
from culet.rendering.device import Real
from culet.rendering.features import Features, Geometry, Stones, by_half_spaces
from culet.rendering.layout import struct
from culet.rendering.mirrors import makes_finite_group
from culet.rendering.placed_stone import PlacedStone, origin_of
from culet.rendering.projection import Projection, project
from culet.rendering.shadows import shadow_planes
from culet.rendering.studio import contact_form, shade_reach
from culet.rendering.surfaces import shown_surfaces
from culet.rendering.tree import WIDTH, Tree, tree_of
from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, StudioFloor

Array = NDArray[np.float64]

GROUP = 8
"""Stones of a group, at most."""
REACH = 1.00005
"""A stone's radius to what rays are tested against, besides ROUNDING: half the 1e-4 that kernels allow one stone."""
ROUNDING = 4e-6
"""Of a position in single precision, in parts of its distance from the frame's origin: some times 6e-8 at each step."""
MARGIN = 3
"""Pixels about the rectangle where a stone is seen: filters reach one pixel further."""
FAR = 2**30
"""A pixel beyond all pictures."""


@dataclass(frozen=True, eq=False)
class StoneTable:
    """Arrays by the kernels' names; what a program does not read is a row of zeros, or None."""

    stones: NDArray[np.void]
    groups: NDArray[np.void]
    facets: Array
    """(F, 4)"""
    blocks: Array
    """(B, 4, WIDTH): the facets of a stone, WIDTH abreast."""
    shadows: Array
    """(P, 4)"""
    tree: Tree | None

    @classmethod
    def of(
        cls,
        scene: Scene,
        stones: Sequence[PlacedStone],
        width: int,
        height: int,
        features: Features,
        real: Real,
    ) -> StoneTable:
        """For a picture of that size. The stones must be in groups: see `grouped`."""
        rows = np.zeros(max(1, len(stones)), struct("stone_t", real))
        rows["radius"] = rows["inverse_radius"] = 1
        origin = origin_of(scene, stones)
        sets, kinds = chains_of_stones(scene)
        absorbed = [stone.scale * np.array(absorption(scene, stone)) for stone in kinds]
        facets, blocks, shadows, trees = [np.zeros((1, 4))], [np.zeros((0, 4, WIDTH))], [np.zeros((1, 4))], []
        first_facet, first_block, first_plane, root, leaves = 1, 0, 1, 0, 0
        for row, stone in zip(rows, stones, strict=False):
            centre = stone.centre - origin
            row["centre"], row["radius"], row["inverse_radius"] = centre, stone.scale, 1 / stone.scale
            row["reach"] = REACH * stone.scale + ROUNDING * float(np.linalg.norm(centre))
            row["axes"] = stone.rotation
            row["absorption"] = absorbed[sets[stone.number]]
            row["convex"] = stone.shape.convex
            row["few_mirrors"] = makes_finite_group(stone.shape)
            row["first_chain"] = sets[stone.number]
            if isinstance(scene.floor, StudioFloor) and stone.centre[1] > FLOOR_Y:
                row["contact"], row["contact_shadow"] = contact_form(stone), scene.floor.shadow
                row["shade_reach"] = stone.scale * shade_reach(stone, len(stones))
            by_triangles = features.geometry == Geometry.MESH and (
                not by_half_spaces(stone.shape) or features.stones == Stones.ONE
            )
            row["by_triangles"] = by_triangles
            row["first_facet"], row["facets"] = first_facet, len(stone.shape.planes)
            if by_triangles:
                tree = tree_of(stone.shape)
                trees.append(tree.moved(root, leaves))
                row["root"] = root
                root, leaves = root + len(tree.links), leaves + len(tree.corners)
                continue
            planes = stone.planes
            facets.append(planes)
            blocks.append(_abreast(planes))
            row["first_block"], row["blocks"] = first_block, len(blocks[-1])
            first_facet, first_block = first_facet + len(planes), first_block + len(blocks[-1])
            if features.lights != 0:
                volumes = _shadow_volumes(scene, stone, planes)
                starts = first_plane + np.cumsum([0, *map(len, volumes)])
                row["shadow_start"][: len(starts)] = starts
                shadows += volumes
                first_plane = int(starts[-1])
        if features.stones == Stones.MANY and stones:
            centres, reach = rows["centre"].astype(float), rows["reach"].astype(float)
            rows["columns"], rows["rows"] = _seen(project(scene, stones, width, height), centres, reach, width, height)
        # One stone has its facets from the first on: kernels need not ask where they begin.
        one = features.stones == Stones.ONE and len(facets) > 1
        rows["first_facet"] -= one
        return cls(
            rows,
            _groups(rows[: len(stones)], real),
            np.vstack(facets[1:] if one else facets),
            np.concatenate([*blocks, np.zeros((1, 4, WIDTH))]),
            np.vstack(shadows),
            Tree.joined(trees) if trees else None,
        )


def grouped(stones: Sequence[PlacedStone]) -> list[PlacedStone]:
    """The stones in such an order that those of a group are near each other: halved across their widest side, until a
    half makes a group."""
    if len(stones) <= GROUP:
        return list(stones)
    centres = np.array([stone.centre for stone in stones])
    axis = int(np.ptp(centres, axis=0).argmax())
    order = np.argsort(centres[:, axis], kind="stable")
    middle = -(-len(stones) // (2 * GROUP)) * GROUP  # all groups but the last are full
    return [*grouped([stones[i] for i in order[:middle]]), *grouped([stones[i] for i in order[middle:]])]


def _groups(rows: NDArray[np.void], real: Real) -> NDArray[np.void]:
    """GROUP stones each, in their order, in a common sphere."""
    count = -(-len(rows) // GROUP)
    groups = np.zeros(max(1, count), struct("group_t", real))
    for number in range(count):
        members = rows[number * GROUP : (number + 1) * GROUP]
        centres = members["centre"].astype(float)
        centre = centres.mean(axis=0)
        group = groups[number]
        group["centre"] = centre
        group["reach"] = (1 + 1e-6) * (np.linalg.norm(centres - centre, axis=1) + members["reach"]).max()
        group["shade_reach"] = (np.linalg.norm(centres - centre, axis=1) + members["shade_reach"]).max()
        group["first"], group["last"] = number * GROUP, number * GROUP + len(members)
    return groups


def _abreast(planes: Array) -> Array:
    """(B, 4, WIDTH), filled up with planes that nothing meets."""
    count = -(-len(planes) // WIDTH)
    rows = np.zeros((count * WIDTH, 4))
    rows[:, 3] = 1
    rows[: len(planes)] = planes
    return rows.reshape(count, WIDTH, 4).transpose(0, 2, 1)


def _shadow_volumes(scene: Scene, stone: PlacedStone, planes: Array) -> list[Array]:
    """The planes of each light, in the stone's own measure."""
    surfaces = shown_surfaces(scene, stone.centre)
    surfaces[:, 3] /= stone.scale
    edges = _edges_of(stone.shape)
    return [shadow_planes(planes, stone.vertices, edges, stone.own(light.position), surfaces) for light in scene.points]


_EDGES: WeakKeyDictionary[Shape, NDArray[np.int32]] = WeakKeyDictionary()


def _edges_of(shape: Shape) -> NDArray[np.int32]:
    """`edges_of_facets`, made once."""
    edges = _EDGES.get(shape)
    if edges is None:
        edges = _EDGES[shape] = edges_of_facets(shape)
    return edges


def _seen(projection: Projection, centres: Array, reach: Array, width: int, height: int) -> tuple[Array, Array]:
    """(N, 2) first and last column, and row, of the pixels whose rays may meet each of N spheres. None: the last is
    before the first.

    By column a pinhole's rays are those of a plane angle, in which the sphere is a disc.
    """
    corner, column, row = projection.direction
    forward = corner + column * (width / 2) + row * (height / 2)
    eye = projection.foot[0] - projection.reach * corner
    ranges = []
    for number, size in ((1, width), (2, height)):
        step = projection.direction[number]
        if not step.any():  # parallel rays
            pitch = float(np.linalg.norm(projection.foot[number]))
            middle = (centres - projection.foot[0]) @ projection.foot[number] / pitch**2
            ranges.append(_pixels(middle - reach / pitch, middle + reach / pitch))
            continue
        pitch = float(np.linalg.norm(step))
        x, z = (centres - eye) @ step / pitch, (centres - eye) @ forward
        distance = np.hypot(x, z)
        angle, half = np.arctan2(x, z), np.arcsin(np.minimum(reach / np.maximum(distance, 1e-300), 1))
        low, high = angle - half, angle + half
        first = np.where(low > -np.pi / 2, np.tan(low) / pitch + size / 2, -FAR)
        last = np.where(high < np.pi / 2, np.tan(high) / pitch + size / 2, FAR)
        behind = (low >= np.pi / 2) | (high <= -np.pi / 2)
        first, last = np.where(behind, FAR, first), np.where(behind, -FAR, last)
        within = distance <= reach
        ranges.append(_pixels(np.where(within, -FAR, first), np.where(within, FAR, last)))
    return ranges[0], ranges[1]


def _pixels(first: Array, last: Array) -> Array:
    return np.column_stack([np.clip(first, -FAR, FAR) - MARGIN, np.clip(last, -FAR, FAR) + MARGIN]).astype(np.int64)
