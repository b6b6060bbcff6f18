"""The tree of triangles: each is in one leaf, inside all boxes above it, and no ray has too many waiting."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from culet.geometry.shape import MassProperties, Shape
from culet.rendering.stones import tree
from culet.rendering.stones.tree import WIDTH, tree_of

SCALES = 9


def nested(scales: int) -> Shape:
    """Detail in a corner of detail: of each scale half as many triangles as of the one before, in a hundredth of the
    area; split at the median along x, the scales come apart one by one. It is no closed stone."""
    random = np.random.default_rng(1)
    parts: list[NDArray[np.float64]] = []
    for scale in range(scales):
        count, size = 16 * 2 ** (scales - 1 - scale), 0.1**scale
        centres = size * random.random((count, 1, 3))
        centres[..., 0] = size * (0.1 + 0.9 * random.random((count, 1)))
        parts.append(centres + 0.05 * size / np.sqrt(count) * random.random((count, 3, 3)))
    corners = np.concatenate(parts)
    triangles = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    facets, planes = np.zeros(len(corners), np.int32), np.array([[0, 0, 1, 0]], np.float64)
    return Shape("nested", corners.reshape(-1, 3), triangles, facets, planes, False, MassProperties(1, np.eye(3)))


def depth_of(planted: tree.Tree) -> int:
    """In nodes."""
    level, depth = [0], 0
    while level:
        depth += 1
        level = [int(link) for node in level for link in planted.links[node] if link >= 0]
    return depth


@pytest.mark.parametrize("depth", [6, 5, 3])
def test_detail_in_detail_has_a_tree_for_which_there_is_room(depth: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With room for fewer nodes than there is, so that an eighth of the triangles does: nodes that cost least make
    6 of splits that cost least, 5 of those at the median, and 3 are the fewest."""
    monkeypatch.setattr(tree, "STACK", (WIDTH - 1) * depth + 1)
    shape = nested(SCALES)
    planted = tree_of(shape)
    assert depth_of(planted) == depth
    within = {0: (np.full(3, -np.inf), np.full(3, np.inf))}
    found = 0
    for node, links in enumerate(planted.links):
        for place, link in enumerate(links):
            box = planted.boxes[node, :6, place].reshape(2, 3)
            if link >= 0:
                within[int(link)] = box[0], box[1]
            elif ~link:
                rows = planted.corners[~link].T
                corners = rows[rows[:, 9:].any(axis=1), :9].reshape(-1, 3, 3)
                found += len(corners)
                assert (corners >= box[0]).all()
                assert (corners <= box[1]).all()
                assert (corners >= within[node][0]).all()
                assert (corners <= within[node][1]).all()
    assert found == len(shape.triangles)
