"""Surfaces that need a repair before they are closed: shared walls, T-junctions, seams that gape."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from culet.errors import MeshError
from culet.geometry.brilliant import brilliant
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.shape import Shape
from culet.scene.cuts import BrilliantCut
from geometry.shapes import Points, Polygons, cube, obj, said, stl

WILD = Path(__file__).with_name("wild")
BRILLIANT = brilliant(BrilliantCut())
CUBE, FACES = cube()


def from_obj(corners: Points, polygons: Polygons) -> Shape:
    return shape_from_mesh(obj(corners, polygons), "obj")


def boxes(*cells: tuple[int, int, int], diagonals: int = 0) -> tuple[Points, list[list[int]]]:
    """Closed unit boxes at these places, every second one with its faces cut by the other diagonal."""
    corners = np.concatenate([(CUBE + 1) / 2 + cell for cell in cells])
    polygons = []
    for number in range(len(cells)):
        for face in FACES:
            a, b, c, d = np.roll(face, number + diagonals) + 8 * number
            polygons += [[int(a), int(b), int(c)], [int(a), int(c), int(d)]]
    return corners, polygons


def test_a_doublet_whose_wall_is_cut_by_other_diagonals_is_one_stone() -> None:
    stone = shape_from_mesh((WILD / "doublet_wall_other_diagonal.obj").read_bytes(), "obj")
    assert (stone.convex, len(stone.planes)) == (True, 6)
    assert stone.mass.volume == pytest.approx(2 / 1.5**1.5)  # 2 x 1 x 1, its half diagonal sqrt(1.5)
    assert said(stone, "4 triangles of inner walls: dropped")


@pytest.mark.parametrize(
    ("cells", "facets"),
    [
        ([(0, 0, 0), (1, 0, 0)], 6),
        ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], 6),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], 6),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0)], 8),
        ([(x, y, z) for x in range(3) for y in range(3) for z in range(3)], 6),
    ],
    ids=["two", "a row", "a square", "an L", "three cubed"],
)
@pytest.mark.parametrize("file_type", ["obj", "stl"])
def test_bodies_wall_to_wall_become_one_whatever_their_diagonals(
    cells: list[tuple[int, int, int]], facets: int, file_type: str
) -> None:
    corners, polygons = boxes(*cells)
    data = obj(corners, polygons) if file_type == "obj" else stl(corners, np.array(polygons, np.int64))
    stone = shape_from_mesh(data, file_type)
    assert len(stone.planes) == facets
    extent = np.ptp(np.array(cells), axis=0) + 1
    if facets == 6:
        assert stone.mass.volume == pytest.approx(len(cells) / (np.linalg.norm(extent) / 2) ** 3)


def test_a_wall_given_once_between_two_cells_is_dropped() -> None:
    corners, polygons = boxes((0, 0, 0), (1, 0, 0))
    inner = [k for k, p in enumerate(polygons) if (corners[p][:, 0] == 1).all()]
    assert len(inner) == 4
    del polygons[inner[2]], polygons[inner[3] - 1]  # one of the two walls
    stone = from_obj(corners, polygons)
    assert (stone.convex, len(stone.planes)) == (True, 6)
    assert said(stone, "2 triangles of inner walls: dropped")


def test_bodies_that_share_an_edge_or_a_part_of_a_wall_stay_two() -> None:
    for cells in ([(0, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 0, 0)]):
        corners, polygons = boxes(*cells)
        if cells[1] == (1, 0, 0):
            corners[8:] = (corners[8:] - [1, 0, 0]) * 0.5 + [1, 0.25, 0.25]
        stone = from_obj(corners, polygons)
        assert said(stone, "2 bodies", "1 smaller closed body left out")
        assert len(stone.planes) == 6


def with_t_junctions(corners: Points, polygons: Polygons, face: int, shares: list[float]) -> tuple[Points, Polygons]:
    """A quad cut into slices across its first side, its neighbours as they were."""
    a, b, c, d = polygons[face]
    added: list[Points] = []
    low, high = [a], [d]
    for share in shares:
        added += [corners[a] + share * (corners[b] - corners[a]), corners[d] + share * (corners[c] - corners[d])]
        low.append(len(corners) + len(added) - 2)
        high.append(len(corners) + len(added) - 1)
    low.append(b)
    high.append(c)
    slices = [[low[k], low[k + 1], high[k + 1], high[k]] for k in range(len(low) - 1)]
    return np.vstack([corners, *added]), [*polygons[:face], *polygons[face + 1 :], *slices]


@pytest.mark.parametrize("shares", [[0.5], [0.3, 0.31, 0.9], list(np.linspace(0.01, 0.99, 60))])
def test_a_side_against_several_is_cut_where_they_meet(shares: list[float]) -> None:
    stone = from_obj(*with_t_junctions(CUBE, FACES, 4, shares))
    assert (stone.convex, len(stone.planes), len(stone.vertices)) == (True, 6, 8)
    assert said(stone, "2 sides cut where another's corner lies on it")


def test_t_junctions_on_every_side_of_a_face_are_mended() -> None:
    corners, polygons = with_t_junctions(CUBE, FACES, 4, [0.5])
    corners, polygons = with_t_junctions(corners, polygons, 0, [0.25, 0.5])
    corners, polygons = with_t_junctions(corners, polygons, 0, [0.75])
    stone = from_obj(corners, polygons)
    assert (stone.convex, len(stone.planes), len(stone.vertices)) == (True, 6, 8)


def loosened(size: float, seed: int = 5) -> tuple[Points, Polygons]:
    """The brilliant with corners of its own for each triangle, moved by up to `size` of the extent along each axis."""
    loose = BRILLIANT.vertices[BRILLIANT.triangles].reshape(-1, 3)
    extent = float(np.ptp(BRILLIANT.vertices, axis=0).max())
    loose = loose + np.random.default_rng(seed).uniform(-size, size, loose.shape) * extent
    return loose, np.arange(len(loose)).reshape(-1, 3).tolist()


@pytest.mark.parametrize(("size", "told"), [(1e-7, "1e-06"), (3e-6, "1e-05"), (2e-5, "0.0001")])
def test_corners_up_to_1e_4_of_the_extent_apart_are_joined_and_told(size: float, told: str) -> None:
    stone = from_obj(*loosened(size))
    assert said(stone, f"nearer than {told} of the extent to another joined, the farthest")
    assert stone.mass.volume == pytest.approx(BRILLIANT.mass.volume, rel=100 * size)  # measured 6 times the size
    assert len(stone.vertices) == 57


def test_a_wider_gap_is_refused_with_its_width() -> None:
    with pytest.raises(MeshError, match=r"open: \d+ boundary edges, the widest gap 0\.0\d+ of the extent") as refused:
        from_obj(*loosened(1e-2))
    width = float(str(refused.value).split("widest gap ")[1].split(" ")[0])
    assert 5e-3 < width < 4e-2
    assert "gaps of at most 0.0001, which are closed" in str(refused.value)


def test_joining_is_judged_by_the_body_not_by_what_lies_beside_it() -> None:
    """1e-4 of a ground plane 200 times as wide as the stone would be a fiftieth of it."""
    corners, polygons = loosened(2e-3)
    ground = np.array([(-200, -1, -200), (200, -1, -200), (200, -1, 200), (-200, -1, 200)], np.float64)
    with pytest.raises(MeshError, match="open"):
        from_obj(np.vstack([corners, ground]), [*polygons, [len(corners) + k for k in range(4)]])


def test_a_large_open_stone_is_mended_before_a_small_closed_one_is_taken() -> None:
    corners, polygons = loosened(2e-5)
    stone = from_obj(np.vstack([corners, CUBE / 20 + 3]), [*polygons, *[[c + len(corners) for c in f] for f in FACES]])
    assert len(stone.vertices) == 57
    assert said(stone, "2 bodies", "1 smaller closed body left out")
