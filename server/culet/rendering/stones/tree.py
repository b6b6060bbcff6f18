"""The tree of boxes over a stone's triangles, as mesh.cl reads it.

A binary tree by the surface area heuristic (MacDonald & Booth, Visual Computer 6, 153 (1990)), binned, down to leaves
of WIDTH triangles; then nodes of up to WIDTH children that cost a ray least (Ylitie, Karras & Laine, Efficient
Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017, section 3.1).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.rendering.opencl.layout import constants

WIDTH = constants("mesh.cl")["TREE_WIDTH"]
"""Children of a node, and triangles of a leaf."""
STACK = constants("mesh.cl")["TREE_STACK"]
"""Nodes that a ray may have waiting."""
BINS = 32
"""Places at which a split is tried, along each axis."""

NODE_COST, LEAF_COST = 1.0, 1.4
"""Of looking into one, for a ray that passes its box: as measured, 22 and 30 ns."""

MARGIN = 4e-6
"""R by which boxes are larger than what they hold: single precision rounds coordinates of up to 1, and the products of
a ray's crossing with a box's side, by 6e-8 each; a ray may start outside by a few times that."""

Array = NDArray[np.float64]
NOWHERE = (1e15, -2e15, 3e15)
"""The box of a child that does not exist, R. The odd ray that points there finds the first leaf, which is empty."""


@dataclass(frozen=True, eq=False)
class Tree:
    """Nodes in breadth-first order, the root first."""

    boxes: Array
    """(N, 12, WIDTH): of each child the lower x, y, z and upper x, y, z of its box, and the same of its normals: a
    child whose triangles all face the wrong way need not be looked into."""
    links: NDArray[np.int32]
    """(N, WIDTH): the child's node, or ~leaf."""
    corners: Array
    """(L, 12, WIDTH): three corners, the facet's normal; zeros where a leaf is not full. The first is empty."""

    def moved(self, nodes: int, leaves: int) -> Tree:
        """The same behind so many nodes and leaves of other trees."""
        return Tree(self.boxes, np.where(self.links >= 0, self.links + nodes, self.links - leaves), self.corners)

    @classmethod
    def joined(cls, trees: Sequence[Tree]) -> Tree:
        """Several trees in one, each `moved` behind those before it."""
        return cls(
            np.concatenate([tree.boxes for tree in trees]),
            np.concatenate([tree.links for tree in trees]).astype(np.int32),
            np.concatenate([tree.corners for tree in trees]),
        )


@dataclass(eq=False)
class _Branch:
    """A node of the binary tree; a leaf has no children."""

    lower: Array
    upper: Array
    triangles: NDArray[np.int64]
    children: tuple[_Branch, _Branch] | None = None
    costs: Array = field(default_factory=lambda: np.empty(0))
    """What it costs at least as at most 1, 2, .. WIDTH children of a node, times the area of everything,"""
    shares: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, np.intp))
    """and how many of those its first child then is; 0: it is one child, a node of its own or a leaf."""

    @property
    def area(self) -> float:
        """Half the box's surface."""
        x, y, z = self.upper - self.lower
        return float(x * y + y * z + z * x)


_TREES: WeakKeyDictionary[Shape, Tree] = WeakKeyDictionary()
"""Kept as long as their shapes: a tree is as large as its mesh."""


def has_tree(shape: Shape) -> bool:
    """Whether `tree_of` has it already."""
    return shape in _TREES


def tree_of(shape: Shape) -> Tree:
    """The tree of a shape; made once, since shapes are immutable."""
    tree = _TREES.get(shape)
    if tree is None:
        tree = _TREES[shape] = _planted(shape)
    return tree


def _planted(shape: Shape) -> Tree:
    corners = shape.vertices[shape.triangles]
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    for by_median in (False, True):
        branches = _grow(lower, upper, by_median=by_median)
        for branch in reversed(branches):
            _weigh(branch)
        tree, depth = _collapse(branches[0], shape, corners, _adopt)
        if _has_room(depth):
            return tree
    # Where each scale of detail is a small part of the one before, nodes that cost least follow it, one a scale.
    tree, depth = _collapse(branches[0], shape, corners, _descendants)
    if not _has_room(depth):
        raise AssertionError("splits at the median halve a node, so 2^32 triangles need no more than STACK")
    return tree


def _has_room(depth: int) -> bool:
    """Whether a ray may have all waiting that it meets in a tree so deep."""
    return (WIDTH - 1) * depth + 1 <= STACK


def _grow(lower: Array, upper: Array, *, by_median: bool) -> list[_Branch]:
    """All branches, each before its children."""
    centres = (lower + upper) / 2
    root = _Branch(lower.min(axis=0), upper.max(axis=0), np.arange(len(lower)))
    branches = [root]
    for branch in branches:
        if len(branch.triangles) <= WIDTH:
            continue
        left = _split(centres[branch.triangles], lower[branch.triangles], upper[branch.triangles], by_median=by_median)
        parts = [branch.triangles[left], branch.triangles[~left]]
        a, b = (_Branch(lower[part].min(axis=0), upper[part].max(axis=0), part) for part in parts)
        branch.children = a, b
        branches += [a, b]
    return branches


def _split(centres: Array, lower: Array, upper: Array, *, by_median: bool) -> NDArray[np.bool_]:
    """Which triangles go to the left: never none, never all."""
    extent = centres.max(axis=0) - centres.min(axis=0)
    axis = int(extent.argmax())
    if extent[axis] > 0 and not by_median:
        splits = [_best_split(centres[:, k], lower, upper) for k in range(3) if extent[k] > 0]
        return min(splits, key=lambda split: split[0])[1]
    count = len(centres)
    left = np.zeros(count, np.bool_)
    left[np.argpartition(centres[:, axis], count // 2)[: count // 2]] = True
    return left


def _best_split(centres: Array, lower: Array, upper: Array) -> tuple[float, NDArray[np.bool_]]:
    """The cheapest split along one axis: its cost, and which triangles go to the left.

    A leaf costs the same however full it is, so what counts is how many leaves the triangles of a side fill.
    """
    place = (centres - centres.min()) / (centres.max() - centres.min())
    number = np.minimum((place * BINS).astype(int), BINS - 1)
    low, high = np.full((BINS, 3), np.inf), np.full((BINS, 3), -np.inf)
    np.minimum.at(low, number, lower)
    np.maximum.at(high, number, upper)
    counts = np.bincount(number, minlength=BINS)
    cost = _costs(low, high, counts)[:-1] + _costs(low[::-1], high[::-1], counts[::-1])[-2::-1]
    best = int(cost.argmin())
    return float(cost[best]), number <= best  # the outermost bins are never empty


def _costs(low: Array, high: Array, counts: NDArray[np.int64]) -> Array:
    """Of the first bin, the first two, and so on: area times leaves."""
    areas = _areas(np.minimum.accumulate(low), np.maximum.accumulate(high))
    costs: Array = np.ceil(counts.cumsum() / WIDTH) * areas
    return costs


def _areas(lower: Array, upper: Array) -> Array:
    x, y, z = np.maximum(upper - lower, 0).T
    areas: Array = x * y + y * z + z * x
    return areas


def _collapse(
    root: _Branch, shape: Shape, corners: Array, adopt: Callable[[_Branch], list[_Branch]]
) -> tuple[Tree, int]:
    """The wide tree of nodes whose children are those that `adopt` gives of a branch, and its depth in nodes."""
    boxes, links, leaves, depth = [], [], [np.empty(0, np.int64)], 0
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-300)
    level = [root]
    numbered = 1
    while level:
        depth += 1
        below: list[_Branch] = []
        for node in level:
            box, link = np.tile(np.array([*NOWHERE, *NOWHERE, *[0] * 6])[:, None], WIDTH), np.full(WIDTH, ~0, np.int32)
            for place, child in enumerate(adopt(node)):
                box[:3, place], box[3:6, place] = child.lower - MARGIN, child.upper + MARGIN
                of_child = turned[child.triangles]
                box[6:9, place], box[9:, place] = of_child.min(axis=0) - MARGIN, of_child.max(axis=0) + MARGIN
                if child.children is None:
                    link[place] = ~len(leaves)
                    leaves.append(child.triangles)
                else:
                    link[place] = numbered
                    numbered += 1
                    below.append(child)
            boxes.append(box)
            links.append(link)
        level = below
    rows = np.zeros((len(leaves), 12, WIDTH))
    normals = shape.planes[shape.facet_of_triangle, :3]
    for number, triangles in enumerate(leaves):
        a, b, c = corners[triangles].transpose(1, 0, 2)
        rows[number, :, : len(triangles)] = np.hstack([a, b, c, normals[triangles]]).T
    return Tree(np.array(boxes), np.array(links), rows), depth


def _weigh(branch: _Branch) -> None:
    """Fill in the costs of a branch whose children have theirs."""
    if branch.children is None:
        branch.costs, branch.shares = np.full(WIDTH, LEAF_COST * branch.area), np.zeros(WIDTH, np.intp)
        return
    first, second = (child.costs for child in branch.children)
    branch.costs, branch.shares = np.empty(WIDTH), np.zeros(WIDTH, np.intp)
    parted = np.inf
    for number in range(2, WIDTH + 1):
        sums = first[: number - 1] + second[number - 2 :: -1]
        share = int(sums.argmin())
        branch.costs[number - 1], branch.shares[number - 1] = sums[share], share + 1
        parted = sums[share]
    alone = NODE_COST * branch.area + parted
    branch.costs[0] = alone
    branch.shares[branch.costs >= alone] = 0
    branch.costs = np.minimum(branch.costs, alone)


def _adopt(node: _Branch) -> list[_Branch]:
    """The children of a node: those of its branch's two, as cheap as can be."""
    if node.children is None:
        return [node]
    first, second = node.children
    share = int((first.costs[: WIDTH - 1] + second.costs[WIDTH - 2 :: -1]).argmin()) + 1
    return _as_children(first, share) + _as_children(second, WIDTH - share)


def _descendants(node: _Branch) -> list[_Branch]:
    """The children of a node in as few levels as can be: its branch's descendants as far down as WIDTH of them go."""
    found = [node]
    for _ in range(WIDTH.bit_length() - 1):
        found = [child for each in found for child in (each.children or (each,))]
    return found


def _as_children(branch: _Branch, most: int) -> list[_Branch]:
    share = int(branch.shares[most - 1])
    if share == 0 or branch.children is None:
        return [branch]
    first, second = branch.children
    return _as_children(first, share) + _as_children(second, most - share)
