"""From loose triangles to one closed, outward wound body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from culet.errors import MeshError

NEAR = 1e-6
"""Vertices within half of this, in units of the mesh's extent, are one, if without it no body is closed: what seven
digits in a file leave of equal corners. Larger closes gaps that were meant; smaller refuses files of six digits."""

Points = NDArray[np.float64]
Triangles = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a set of triangles."""

    of_side: NDArray[np.int64]
    """(3T,) edge of each triangle's side; sides 0-1 of all triangles first, then 1-2, then 2-0."""
    forward: NDArray[np.bool_]
    """(3T,) whether the side runs from the lower vertex to the higher."""
    uses: NDArray[np.int64]
    """(E,) sides that lie on each edge."""

    def pairs(self) -> NDArray[np.int64]:
        """(P, 2) the two sides of each edge that has exactly two."""
        order = np.argsort(self.of_side, kind="stable")
        twice: NDArray[np.int64] = order[self.uses[self.of_side[order]] == 2].reshape(-1, 2)
        return twice


def edges_of(triangles: Triangles) -> Edges:
    """Every edge, once."""
    start, end = triangles.T.ravel(), np.roll(triangles, -1, axis=1).T.ravel()
    key = np.minimum(start, end) * (int(triangles.max(initial=0)) + 1) + np.maximum(start, end)
    _, of_side, uses = np.unique(key, return_inverse=True, return_counts=True)
    return Edges(of_side, start < end, uses)


def weld(vertices: Points, triangles: Triangles) -> tuple[Points, Triangles]:
    """The same triangles on distinct vertices, those that no triangle uses left out."""
    used, compact = np.unique(triangles, return_inverse=True)
    points = vertices[used] + 0.0  # -0 becomes 0
    first, label = _distinct(points)
    return points[first], label[compact].reshape(-1, 3)


def weld_near(vertices: Points, triangles: Triangles, distance: float) -> tuple[Points, Triangles, float]:
    """The same with vertices within `distance` / 2 made one, and how far one of them is from the one that stays.

    Two such points share a cell of width `distance` in at least one of eight grids, each shifted by half a cell along
    some of the axes: linear time, however many points crowd together.
    """
    count = len(vertices)
    links = []
    for shift in np.ndindex(2, 2, 2):
        first, label = _distinct(np.floor(vertices / distance + np.array(shift) / 2))
        links.append(np.column_stack([np.arange(count), first[label]]))
    ends = np.concatenate(links)
    _, label = connected_components(coo_array((np.ones(len(ends)), ends.T), shape=(count, count)), directed=False)
    _, first = np.unique(label, return_index=True)
    moved = vertices - vertices[first[label]]
    farthest = float(np.sqrt(np.einsum("ij,ij->i", moved, moved).max(initial=0.0)))
    return *weld(vertices[first], label[triangles].astype(np.int64)), farthest


def without_collapsed(triangles: Triangles) -> Triangles:
    """Those with three different corners."""
    a, b, c = triangles.T
    solid: Triangles = triangles[(a != b) & (b != c) & (c != a)]
    return solid


def without_duplicates(triangles: Triangles, *, keep_one: bool) -> Triangles:
    """Of triangles on the same three corners, one; or, unless `keep_one`, none where they come in opposite pairs."""
    corners = np.sort(triangles, axis=1)
    _, first, group, count = np.unique(corners, axis=0, return_index=True, return_inverse=True, return_counts=True)
    kept: Triangles = triangles[np.sort(first)] if keep_one else triangles[(count == 1)[group.ravel()]]
    return kept


@dataclass(frozen=True, eq=False)
class SurfacePieces:
    """The connected pieces of a surface, wound alike."""

    triangles: Triangles
    """All of them, each piece's winding consistent where that is possible, and outward where it is closed."""
    piece: NDArray[np.int64]
    """(T,) piece of each triangle; pieces connect across edges of exactly two triangles."""
    open_edges: NDArray[np.int64]
    """(K,) edges of each piece that only one of its triangles uses."""
    crowded_edges: NDArray[np.int64]
    """(K,) edges of each piece that more than two of its triangles use."""
    one_sided: NDArray[np.bool_]
    """(K,) no consistent winding exists, as on a Moebius strip."""
    volume: NDArray[np.float64]
    """(K,) enclosed by each closed piece; 0 for the others."""
    reversed_triangles: NDArray[np.int64]
    """(K,) triangles whose winding was turned round."""

    @property
    def closed(self) -> NDArray[np.bool_]:
        """(K,) pieces that enclose a volume."""
        closed: NDArray[np.bool_] = (self.open_edges == 0) & (self.crowded_edges == 0) & ~self.one_sided
        return closed


def bodies_of(vertices: Points, triangles: Triangles) -> SurfacePieces:
    """Split a surface into pieces and wind each of them alike."""
    count = len(triangles)
    edges = edges_of(triangles)
    sides = edges.pairs()
    ends = sides % count
    graph = coo_array((np.ones(len(ends)), ends.T), shape=(count, count))
    number, piece = connected_components(graph, directed=False)

    # Uses within the piece: bodies that touch along an edge share it without being open there.
    own, uses = np.unique(np.tile(piece.astype(np.int64), 3) * len(edges.uses) + edges.of_side, return_counts=True)
    owner = own // len(edges.uses)
    open_edges = np.bincount(owner[uses == 1], minlength=number)
    crowded = np.bincount(owner[uses > 2], minlength=number)

    against = edges.forward[sides[:, 0]] == edges.forward[sides[:, 1]]  # neighbours wound alike cross opposite ways
    turn = _turns(count, piece, ends, against)
    broken = turn[ends[:, 0]] ^ turn[ends[:, 1]] ^ against
    one_sided = np.bincount(piece[ends[broken, 0]], minlength=number) > 0

    # Prefer the winding that most triangles have already; the sign of the volume decides for closed pieces.
    wound = np.where(turn[:, None], triangles[:, ::-1], triangles)
    a, b, c = (vertices[wound[:, k]] for k in range(3))
    signed = np.bincount(piece, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6, number)
    inward = signed < 0
    turn ^= inward[piece]
    wound = np.where(turn[:, None], triangles[:, ::-1], triangles)
    closed = (open_edges == 0) & (crowded == 0) & ~one_sided
    return SurfacePieces(
        triangles=wound,
        piece=piece.astype(np.int64),
        open_edges=open_edges,
        crowded_edges=crowded,
        one_sided=one_sided,
        volume=np.where(closed, abs(signed), 0.0),
        reversed_triangles=np.bincount(piece[turn], minlength=number),
    )


def refuse_open(bodies: SurfacePieces, gap: float, joined: float) -> MeshError:
    """What keeps the largest piece, by triangles, from being closed.

    `gap` is the mesh's widest, and gaps of `joined` would have been closed, both in units of its extent.
    """
    sizes = np.bincount(bodies.piece)
    worst = int(sizes.argmax())
    of = f"the mesh's {len(sizes)} bodies are all unusable; the largest" if len(sizes) > 1 else "the surface"
    if bodies.open_edges[worst]:
        return MeshError(
            f"{of} is open: {bodies.open_edges[worst]} boundary edges, the widest gap {gap:.2g} of the extent; "
            f"expected a closed surface, or gaps of at most {joined:g}, which are closed"
        )
    if bodies.crowded_edges[worst]:
        return MeshError(
            f"{of} is not a manifold: {bodies.crowded_edges[worst]} edges are shared by more than two triangles"
        )
    return MeshError(f"{of} is one-sided, like a Moebius strip or a Klein bottle: it has no inside")


def _turns(
    count: int, piece: NDArray[np.int32], ends: NDArray[np.int64], against: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """(T,) triangles to turn round so that each agrees with the first of its piece, along a spanning tree."""
    if not against.any():
        return np.zeros(count, np.bool_)
    # One extra node joins the first triangles of all pieces, so that one search reaches everything.
    _, first = np.unique(piece, return_index=True)
    rows = np.concatenate([ends[:, 0], np.full(len(first), count)])
    columns = np.concatenate([ends[:, 1], first])
    weights = np.concatenate([1 + against.astype(np.int64), np.ones(len(first), np.int64)])  # 0 would mean no link
    graph = coo_array((weights, (rows, columns)), shape=(count + 1, count + 1)).tocsr()
    graph = (graph + graph.T).tocsr()
    _, parent = breadth_first_order(graph, count, directed=False, return_predecessors=True)
    parent[count] = count
    nodes = np.arange(count)
    flip = np.zeros(count + 1, np.bool_)
    flip[:count] = np.asarray(graph[nodes, parent[:count]]).ravel() == 2
    while (parent != count).any():  # doubling: each node's parity reaches twice as far every time
        flip ^= flip[parent]
        parent = parent[parent]
    majority = np.bincount(piece, flip[:count]) * 2 > np.bincount(piece)
    turned: NDArray[np.bool_] = flip[:count] ^ majority[piece]
    return turned


def _distinct(rows: Points) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Index of the first of each group of equal rows, and each row's group."""
    order = np.lexsort(rows.T)
    ordered = rows[order]
    fresh = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    label = np.empty(len(rows), np.int64)
    label[order] = np.cumsum(fresh) - 1
    return order[fresh], label
