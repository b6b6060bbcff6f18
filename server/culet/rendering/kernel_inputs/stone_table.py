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
from culet.rendering.features import Features, Geometry, StoneCount, by_half_spaces
from culet.rendering.kernel_inputs.footprint import footprints, reach_of
from culet.rendering.opencl.device import Real
from culet.rendering.opencl.layout import constants, struct
from culet.rendering.projection import Projection
from culet.rendering.room.studio import contact_forms, shade_reach
from culet.rendering.room.surfaces import shown_surfaces
from culet.rendering.stones.facet_rows import facet_rows
from culet.rendering.stones.mirrors import makes_finite_group
from culet.rendering.stones.placed_stone import PlacedStone, by_shape, centres_of
from culet.rendering.stones.shadows import shadow_planes
from culet.rendering.stones.tree import WIDTH, Tree, tree_of
from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, StudioFloor

Array = NDArray[np.float64]

GROUP = 8
"""Stones of a group, at most."""
NEAR_SLACK = constants("stones.cl")["NEAR_STEPS"] * float(np.finfo(np.float32).eps)
"""Parts of squared distances by which spheres count as larger."""


@dataclass(frozen=True, eq=False)
class StoneTable:
    """Arrays by the kernels' names; what a program does not read is a row of zeros, or None."""

    stones: NDArray[np.void]
    groups: NDArray[np.void]
    facets: Array
    """(F, 4): of MANY those of each shape, in the inner axes."""
    blocks: Array
    """(B, 4, WIDTH): of MANY the same, WIDTH abreast."""
    rows: Array
    """(N, 4): the facets of each shape by its symmetry, see facet_rows.py."""
    shadows: Array
    """(P, 4)"""
    tree: Tree | None

    @classmethod
    def of(
        cls,
        scene: Scene,
        stones: Sequence[PlacedStone],
        projection: Projection,
        width: int,
        height: int,
        features: Features,
        real: Real,
    ) -> StoneTable:
        """For a picture of that size. The stones must be in groups: see `grouped`."""
        rows = np.zeros(max(1, len(stones)), struct("stone_t", real))
        rows["radius"] = rows["inverse_radius"] = 1
        if stones:
            _place(rows, scene, stones, projection.origin)
        facets, blocks, shadows, trees = [np.zeros((1, 4))], [np.zeros((0, 4, WIDTH))], [np.zeros((1, 4))], []
        first_facet, first_block, first_row, first_plane, root, leaves = 1, 0, 0, 1, 0, 0
        rows["alike"] = np.arange(len(rows))
        by_symmetry = []
        for shape, numbers in by_shape(stones).items():
            by_triangles = features.geometry == Geometry.MESH and (
                not by_half_spaces(shape) or features.stones == StoneCount.ONE
            )
            rows["by_triangles"][numbers] = by_triangles
            rows["facets"][numbers] = len(shape.planes)
            if by_triangles:
                tree = tree_of(shape)
                trees.append(tree.moved(root, leaves))
                rows["root"][numbers] = root
                root, leaves = root + len(tree.links), leaves + len(tree.corners)
                rows["inner_axes"][numbers] = np.eye(3)
                continue
            symmetric = facet_rows(shape)
            own_rows = symmetric.data(real)
            rows["first_row"][numbers], rows["row_end"][numbers] = first_row, symmetric.ends
            by_symmetry.append(own_rows)
            first_row += len(own_rows)
            rotations = np.array([stones[number].rotation for number in numbers])
            rows["inner_axes"][numbers] = rotations @ symmetric.axes
            rows["first_facet"][numbers], rows["first_block"][numbers] = first_facet, first_block
            if features.stones == StoneCount.MANY:
                rows["alike"][numbers] = numbers[0]
                own = _turned(symmetric.planes, symmetric.axes.T)
                blocks.append(_abreast(own))
                rows["blocks"][numbers] = len(blocks[-1])
                first_block += len(blocks[-1])
            else:
                own = _turned(symmetric.planes, rotations[0])
            facets.append(own)
            first_facet += len(own)
            for number, rotation in zip(numbers, rotations if features.lights != 0 else (), strict=False):
                volumes = _shadow_volumes(scene, stones[number], _turned(symmetric.planes, rotation))
                starts = first_plane + np.cumsum([0, *map(len, volumes)])
                rows["shadow_start"][number, : len(starts)] = starts
                shadows += volumes
                first_plane = int(starts[-1])
        if features.stones == StoneCount.MANY and stones:
            centres, reach = rows["centre"].astype(float), rows["reach"].astype(float)
            rows["columns"], rows["rows"] = footprints(projection, centres, reach, width, height)
        # One stone has its facets from the first on: kernels need not ask where they begin.
        one = features.stones == StoneCount.ONE and len(facets) > 1
        rows["first_facet"] -= one
        return cls(
            rows,
            _groups(rows[: len(stones)], real),
            np.vstack(facets[1:] if one else facets),
            np.concatenate([*blocks, np.zeros((1, 4, WIDTH))]),
            np.concatenate([*by_symmetry, np.zeros((1, 4))]),
            np.vstack(shadows),
            Tree.joined(trees) if trees else None,
        )


def _place(rows: NDArray[np.void], scene: Scene, stones: Sequence[PlacedStone], origin: Array) -> None:
    """Fill in what does not depend on how stones are traced."""
    scales, centres = np.array([stone.scale for stone in stones]), centres_of(stones) - origin
    sets, kinds = chains_of_stones(scene)
    chains = [sets[stone.number] for stone in stones]
    rows["centre"], rows["radius"], rows["inverse_radius"] = centres, scales, 1 / scales
    rows["reach"] = reach_of(scales, centres)
    rows["axes"] = [stone.rotation for stone in stones]
    rows["absorption"] = np.array([stone.scale * np.array(absorption(scene, stone)) for stone in kinds])[chains]
    rows["convex"] = [stone.shape.convex for stone in stones]
    rows["few_mirrors"] = [makes_finite_group(stone.shape) for stone in stones]
    rows["first_chain"] = chains
    if isinstance(scene.floor, StudioFloor):
        standing = [number for number, stone in enumerate(stones) if stone.centre[1] > FLOOR_Y]
        rows["contact"][standing] = contact_forms([stones[number] for number in standing])
        rows["contact_shadow"][standing] = scene.floor.shadow
        rows["shade_reach"][standing] = (scales * shade_reach(stones))[standing]


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
    """GROUP stones each, in their order, in a common sphere. The rows are told where they are in it."""
    count = -(-len(rows) // GROUP)
    groups = np.zeros(max(1, count), struct("group_t", real))
    if not count:
        return groups
    first = GROUP * np.arange(count)
    last = np.minimum(first + GROUP, len(rows))
    members = np.minimum(first[:, None] + np.arange(GROUP), last[:, None] - 1)  # the last of a group may be named again
    centres = rows["centre"].astype(float)
    groups["centre"] = np.add.reduceat(centres, first) / (last - first)[:, None]
    apart = np.linalg.norm(centres[members] - groups["centre"][:, None].astype(float), axis=2)
    groups["reach"] = (1 + 1e-6) * (apart + rows["reach"][members]).max(axis=1)
    groups["shade_reach"] = (apart + rows["shade_reach"][members]).max(axis=1)
    groups["first"], groups["last"] = first, last
    own = centres - groups["centre"].astype(float)[np.arange(len(rows)) // GROUP]
    rows["apart"] = own
    rows["power"] = (1 - NEAR_SLACK) * (own * own).sum(axis=1) - rows["reach"].astype(float) ** 2
    return groups


def _turned(planes: Array, rotation: Array) -> Array:
    """Half-spaces, (F, 4), in other axes."""
    return np.column_stack([planes[:, :3] @ rotation.T, planes[:, 3]])


def _abreast(planes: Array) -> Array:
    """(B, 4, WIDTH) of (F, 4), filled up with planes that nothing meets."""
    rows = np.zeros((-(-len(planes) // WIDTH) * WIDTH, 4))
    rows[:, 3] = 1
    rows[: len(planes)] = planes
    return rows.reshape(-1, WIDTH, 4).transpose(0, 2, 1)


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
