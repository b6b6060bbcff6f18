"""Walls inside a surface, which keep its bodies from being closed.

Two bodies that touch along a whole wall, a doublet's halves or a stone and its setting, share the wall's rim: each edge
of the rim has four triangles, two of each body, and nothing says which belong together. Where both walls are cut into
the same triangles, they are found as duplicates; here are walls that are cut by other diagonals.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from culet.geometry.facets import FLATNESS
from culet.geometry.surface import Points, Triangles, edges_of


def without_shared_walls(vertices: Points, triangles: Triangles) -> Triangles:
    """The surface without its flat inner walls.

    A wall is a flat piece whose rim has three triangles or more at every edge. A wall is inner if another has the same
    rim, or if every edge of its rim has an odd number of triangles, as has that of a wall between two cells.
    """
    count = len(triangles)
    edges = edges_of(triangles)
    ends = edges.pairs() % count
    number, piece = connected_components(coo_array((np.ones(len(ends)), ends.T), shape=(count, count)), directed=False)
    uses = edges.uses[edges.of_side]
    owner = np.tile(piece, 3)
    crowded = (np.bincount(owner[uses > 2], minlength=number) > 0) & (
        np.bincount(owner[uses == 1], minlength=number) == 0
    )
    rim = (uses > 2) & crowded[owner]
    order = np.argsort(owner[rim], kind="stable")
    rims, rim_bounds = edges.of_side[rim][order], np.searchsorted(owner[rim][order], np.arange(number + 1))
    members = np.argsort(piece, kind="stable")
    bounds = np.searchsorted(piece[members], np.arange(number + 1))
    walls: dict[bytes, list[int]] = {}
    for k in np.flatnonzero(crowded).tolist():
        if _flat(vertices[triangles[members[bounds[k] : bounds[k + 1]]]].reshape(-1, 3)):
            walls.setdefault(np.sort(rims[rim_bounds[k] : rim_bounds[k + 1]]).tobytes(), []).append(k)
    inner = [
        k
        for own_rim, alike in walls.items()
        if len(alike) % 2 == 0 or (edges.uses[np.frombuffer(own_rim, np.int64)] % 2 == 1).all()
        for k in alike
    ]
    kept: Triangles = triangles[~np.isin(piece, inner)]
    return kept


def _flat(points: NDArray[np.float64]) -> bool:
    """Whether the points lie in one plane, to the flatness of facets in units of their extent or of the mesh's."""
    around = points - points.mean(axis=0)
    normal = np.linalg.svd(around.T @ around)[2][-1]
    return bool(abs(around @ normal).max() <= FLATNESS * max(1.0, float(abs(around).max())))
