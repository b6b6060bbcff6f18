"""Untidy meshes: what is repaired and said, what is refused by its defect's name, and what is convex."""

from __future__ import annotations

import time

import numpy as np
import pytest
import trimesh

from culet.errors import MeshError
from culet.geometry.brilliant import brilliant
from culet.geometry.mesh import shape_from_mesh
from culet.geometry.polygons import edges_of_facets
from culet.geometry.shape import Shape
from culet.scene.cuts import BrilliantCut
from geometry.shapes import Points, Polygons, cube, exported, fans, obj, prism, said, star_outline, stl

BRILLIANT = brilliant(BrilliantCut())
CUBE, FACES = cube()
TRIANGLES = fans(FACES)


def from_obj(corners: Points, polygons: Polygons) -> Shape:
    return shape_from_mesh(obj(corners, polygons), "obj")


def moved_copies(*offsets: tuple[float, float, float]) -> tuple[Points, Polygons]:
    corners = np.vstack([CUBE + offset for offset in offsets])
    return corners, [[c + 8 * k for c in face] for k in range(len(offsets)) for face in FACES]


def is_the_cube(stone: Shape) -> bool:
    return stone.convex and len(stone.planes) == 6 and bool(np.allclose(abs(stone.vertices), 3**-0.5))


# What is repaired, and said


def test_an_inside_out_surface_is_turned() -> None:
    stone = from_obj(CUBE, [face[::-1] for face in FACES])
    assert is_the_cube(stone)
    assert said(stone, "inside out", "every triangle")


@pytest.mark.parametrize("wrong", [[0], [1, 4], [0, 2, 3, 4, 5]])
def test_mixed_winding_is_repaired_and_counted(wrong: list[int]) -> None:
    stone = from_obj(CUBE, [face[::-1] if k in wrong else face for k, face in enumerate(FACES)])
    assert is_the_cube(stone)
    assert said(stone, f"Winding repaired: {2 * len(wrong)} of 12 triangles")


def test_of_several_bodies_the_largest_is_taken() -> None:
    corners, faces = moved_copies((0, 0, 0), (9, 0, 0), (0, 9, 0))
    corners[8:16] *= 1.5
    stone = from_obj(corners, faces)
    assert is_the_cube(stone)
    assert said(
        stone, "3 bodies", "largest closed one by volume taken (12 triangles), 2 smaller closed bodies left out"
    )


def test_a_ground_plane_beside_the_gem_is_left_out() -> None:
    """The plane is 100 times as wide as the stone: the stone keeps its facets all the same."""
    ground = [(-99, -1, -99), (99, -1, -99), (99, -1, 99), (-99, -1, 99)]
    corners = np.vstack([BRILLIANT.vertices, ground])
    stone = shape_from_mesh(stl(corners, np.vstack([BRILLIANT.triangles, [(57, 59, 58), (57, 60, 59)]])), "stl")
    assert (len(stone.planes), len(stone.vertices)) == (73, 57)
    assert said(stone, "2 bodies", "1 surface that is not closed (2 triangles) left out")


def test_bodies_that_touch_along_an_edge_stay_two() -> None:
    stone = from_obj(*moved_copies((0, 0, 0), (2, 2, 0)))
    assert is_the_cube(stone)
    assert said(stone, "2 bodies")


def test_bodies_that_share_a_wall_become_one() -> None:
    stone = from_obj(*moved_copies((0, 0, 0), (2, 0, 0)))
    assert (len(stone.planes), len(stone.vertices)) == (6, 8)
    assert stone.mass.volume == pytest.approx(16 / np.sqrt(6) ** 3)  # 4 x 2 x 2, its half diagonal sqrt 6
    assert said(stone, "4 triangles of inner walls: dropped")


def test_triangles_given_twice_and_collapsed_ones_are_dropped() -> None:
    stone = from_obj(CUBE, [*TRIANGLES.tolist(), *TRIANGLES[:, ::-1].tolist(), [0, 1, 1], [2, 2, 2]])
    assert is_the_cube(stone)
    assert said(stone, "12 triangles given more than once: dropped")
    assert said(stone, "2 of 26 triangles degenerate", "dropped")


def test_nearly_equal_vertices_are_joined_only_where_the_surface_would_be_open() -> None:
    loose = np.vstack([CUBE[t] for t in TRIANGLES])
    random = np.random.default_rng(3)
    loose += random.uniform(-1e-7, 1e-7, loose.shape)
    stone = from_obj(loose, np.arange(36).reshape(-1, 3).tolist())
    assert (len(stone.planes), len(stone.vertices)) == (6, 8)
    assert said(stone, "28 vertices nearer than 1e-06 of the extent to another joined")
    with pytest.raises(MeshError, match="open"):
        from_obj(loose + random.uniform(-1e-3, 1e-3, loose.shape), np.arange(36).reshape(-1, 3).tolist())


def test_a_fin_on_a_closed_body_is_left_out() -> None:
    stone = from_obj(np.vstack([CUBE, [(3, 3, 3)]]), [*FACES, [0, 1, 8]])
    assert is_the_cube(stone)
    assert said(stone, "1 surface that is not closed (1 triangle) left out")


def test_vertices_that_no_face_uses_are_left_out_whatever_they_are() -> None:
    stone = from_obj(np.vstack([CUBE, [(np.nan, 1, 2), (1e300, 0, 0)]]), FACES)
    assert is_the_cube(stone)
    assert said(stone, "2 vertices that no face uses left out")


# What is refused, by its defect's name


def test_an_open_surface_is_refused_with_its_boundary() -> None:
    with pytest.raises(MeshError, match="the surface is open: 4 boundary edges, the widest gap 1 of the extent"):
        from_obj(CUBE, FACES[1:])
    corners, _ = moved_copies((0, 0, 0), (9, 0, 0))
    with pytest.raises(MeshError, match="2 bodies are all unusable; the largest is open: 3 boundary edges"):
        shape_from_mesh(stl(corners, np.vstack([TRIANGLES[1:], TRIANGLES[2:] + 8])), "stl")


@pytest.mark.parametrize("height", [0.0, 1e-7])
def test_a_flat_mesh_is_refused(height: float) -> None:
    with pytest.raises(MeshError, match="the mesh is flat"):
        from_obj(*prism(star_outline(), height))


def test_a_body_of_collinear_corners_is_refused() -> None:
    with pytest.raises(MeshError, match=r"flat|no volume"):
        from_obj(np.outer(np.arange(4.0), [1, 1, 1]), [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])


@pytest.mark.parametrize(("far", "defect"), [(1e10, "too small to be read exactly"), (1e300, "degenerate")])
def test_a_body_lost_beside_something_far_away_is_refused(far: float, defect: str) -> None:
    with pytest.raises(MeshError, match=defect):
        from_obj(np.vstack([CUBE, [(far, 0, 0)]]), [*FACES, [0, 1, 8]])


def test_a_mesh_of_one_point_is_refused() -> None:
    with pytest.raises(MeshError, match="all its vertices are one point"):
        from_obj(np.ones((3, 3)), [[0, 1, 2]])


def test_a_mesh_of_collapsed_triangles_is_refused() -> None:
    with pytest.raises(MeshError, match="every triangle is degenerate"):
        from_obj(CUBE, [[0, 1, 1], [2, 3, 3]])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("file_type", ["obj", "off", "stl", "ply", "glb"])
def test_coordinates_that_are_not_finite_are_refused(file_type: str, value: float) -> None:
    corners = BRILLIANT.vertices.copy()
    corners[5, 1] = value
    mesh = trimesh.Trimesh(corners, BRILLIANT.triangles, process=False)
    triangles = BRILLIANT.triangles.astype(np.int64)
    data = stl(corners, triangles) if file_type == "stl" else exported(mesh, file_type)
    with pytest.raises(MeshError, match=r"coordinates that are not finite \(NaN or infinity\)"):
        shape_from_mesh(data, file_type)


def voxels(filled: set[tuple[int, int, int]]) -> tuple[Points, Polygons]:
    """The surface of unit cubes on a grid."""
    quads = []
    for cell in filled:
        for face in FACES:
            square = (CUBE[face] + 1) / 2
            x, y, z = np.array(cell) + np.round(2 * square.mean(axis=0) - 1).astype(int)
            if (int(x), int(y), int(z)) not in filled:
                quads.append(square + cell)
    corners = np.concatenate(quads)
    return corners, np.arange(len(corners)).reshape(-1, 4).tolist()


def test_a_body_that_touches_itself_along_an_edge_is_refused() -> None:
    """Two columns on one slab that meet corner to corner: which side of their common edge is inside?"""
    slab = {(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)}
    with pytest.raises(MeshError, match="not a manifold: 1 edges are shared by more than two triangles"):
        from_obj(*voxels(slab | {(0, 0, 1), (1, 1, 1)}))
    assert not from_obj(*voxels(slab | {(0, 0, 1)})).convex


def klein_bottle(n: int = 24) -> tuple[Points, Polygons]:
    u, w = (2 * np.pi * grid.ravel() / n for grid in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    across = 2 + np.cos(u / 2) * np.sin(w) - np.sin(u / 2) * np.sin(2 * w)
    up = np.sin(u / 2) * np.sin(w) + np.cos(u / 2) * np.sin(2 * w)

    def at(i: int, j: int) -> int:
        return (j % n if i < n else -j % n) + (i % n) * n

    quads = [[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)] for i in range(n) for j in range(n)]
    return np.column_stack([across * np.cos(u), across * np.sin(u), up]), quads


def test_a_one_sided_surface_is_refused() -> None:
    with pytest.raises(MeshError, match="one-sided"):
        from_obj(*klein_bottle())


BOW_TIE = np.array([(0, 0), (3, 2), (3, 0), (0, 1)], np.float64)
PENTAGRAM = np.column_stack([f(np.arange(5) * 4 * np.pi / 5) for f in (np.cos, np.sin)])


@pytest.mark.parametrize("outline", [BOW_TIE, PENTAGRAM], ids=["bow tie", "pentagram"])
def test_walls_that_pass_through_each_other_are_refused(outline: Points) -> None:
    with pytest.raises(MeshError, match="the mesh crosses itself: two of its faces meet near"):
        from_obj(*prism(outline, 1))


def test_a_spindle_torus_is_refused_and_a_ring_is_not() -> None:
    spindle = trimesh.creation.torus(0.5, 0.7, major_sections=40, minor_sections=40)
    with pytest.raises(MeshError, match="crosses itself"):
        shape_from_mesh(exported(spindle, "ply"), "ply")
    ring = trimesh.creation.torus(1, 0.3, major_sections=40, minor_sections=40)
    stone = shape_from_mesh(exported(ring, "ply"), "ply")
    assert not stone.convex
    assert len(stone.vertices) - len(edges_of_facets(stone)) + len(stone.planes) == 0  # Euler: one hole


# Convex or not


def test_every_stone_says_whether_it_is_convex() -> None:
    assert said(from_obj(CUBE, FACES), "Convex: 12 triangles in the file, 6 facets.")
    star = from_obj(*prism(star_outline(), 0.6))
    assert not star.convex
    assert said(star, "Not convex: dented by", "36 triangles in the file, 12 facets")


def test_a_heart_is_not_convex() -> None:
    t = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    outline = np.column_stack(
        [16 * np.sin(t) ** 3, 13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t)]
    )[::-1]
    stone = from_obj(*prism(outline, 6))
    assert not stone.convex
    assert len(stone.planes) == 66
    mesh = trimesh.Trimesh(stone.vertices, stone.triangles, process=False)
    assert mesh.is_volume


def dented_table(depth: float) -> tuple[Points, Polygons]:
    """The brilliant with a ninth corner in the middle of its table, `depth` below it."""
    table = BRILLIANT.facet_of_triangle == 0
    ring = np.unique(BRILLIANT.triangles[table])
    x, y, z = BRILLIANT.vertices[ring].T
    ring = ring[np.argsort(np.arctan2(-z, x))]
    corners = np.vstack([BRILLIANT.vertices, [(0, y[0] - depth, 0)]])
    fan = [[int(ring[k]), int(ring[(k + 1) % 8]), len(corners) - 1] for k in range(8)]
    return corners, [*BRILLIANT.triangles[~table].tolist(), *fan]


@pytest.mark.parametrize("depth", [1e-3, 1e-2, 0.1])
def test_a_dent_is_seen(depth: float) -> None:
    stone = from_obj(*dented_table(depth))
    assert not stone.convex
    assert len(stone.planes) == 72 + 8


@pytest.mark.parametrize(("depth", "filled"), [(0.0, False), (5e-7, False), (5e-5, True)])
def test_a_dent_of_rounding_is_filled_and_said(depth: float, filled: bool) -> None:
    """`DENT` is 2e-4 of the mean thickness, which is 0.55 R in this cut."""
    stone = from_obj(*dented_table(depth))
    assert (stone.convex, len(stone.planes), len(stone.vertices)) == (True, 73, 57)
    assert said(stone, "Dents of up to", "filled") is filled


@pytest.mark.parametrize("digits", [4, 5, 6])
def test_coordinates_printed_with_few_digits_keep_the_facets(digits: int) -> None:
    stone = from_obj(np.round(BRILLIANT.vertices, digits), BRILLIANT.triangles.tolist())
    assert (stone.convex, len(stone.planes), len(stone.vertices)) == (True, 73, 57)
    assert stone.mass.volume == pytest.approx(BRILLIANT.mass.volume, rel=10.0 ** (1 - digits))


def test_a_cube_in_many_triangles_has_six_facets_and_eight_corners() -> None:
    box = trimesh.creation.box()
    for _ in range(4):
        box = box.subdivide()
    stone = shape_from_mesh(exported(box, "stl"), "stl")
    assert len(box.faces) == 3072
    assert (len(stone.planes), len(stone.vertices), len(stone.triangles)) == (6, 8, 12)


@pytest.mark.parametrize("stretch", [1e3, 1e-3], ids=["needle", "wafer"])
def test_thin_stones_in_single_precision_keep_their_facets(stretch: float) -> None:
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    corners = BRILLIANT.vertices * [1, stretch, 1] @ turn
    stone = shape_from_mesh(stl(corners, BRILLIANT.triangles.astype(np.int64)), "stl")
    assert (stone.convex, len(stone.planes), len(stone.vertices)) == (True, 73, 57)


@pytest.mark.parametrize("size", [1e-250, 1e-9, 1e9, 1e300])
def test_size_and_place_do_not_matter(size: float) -> None:
    stone = from_obj((BRILLIANT.vertices + np.array([30, -20, 10])) * size, BRILLIANT.triangles.tolist())
    assert (stone.convex, len(stone.planes)) == (True, 73)
    assert np.linalg.norm(stone.vertices, axis=1).max() == pytest.approx(1, abs=1e-15)
    assert stone.mass.volume == pytest.approx(BRILLIANT.mass.volume, rel=1e-12, abs=0)


def test_a_mesh_too_small_for_its_numbers_is_refused() -> None:
    with pytest.raises(MeshError, match="expected 1e-300 or more"):
        from_obj(CUBE * 1e-310, FACES)


def test_the_origin_is_the_centre_of_mass_or_the_mean_vertex() -> None:
    """A pyramid's centre of mass is a quarter of its height up, its mean vertex a fifth."""
    corners = np.array([(1, 0, 1), (1, 0, -1), (-1, 0, -1), (-1, 0, 1), (0, 4, 0)], np.float64)
    data = obj(corners, [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    by_mass = shape_from_mesh(data, "obj")
    by_mean = shape_from_mesh(data, "obj", centre="vertex_mean")
    assert by_mass.vertices[:, 1].min() == pytest.approx(-1 / 3)  # 1 below, 3 above
    assert by_mean.vertices[:, 1].min() == pytest.approx(-0.8 / 3.2)
    assert abs(by_mean.vertices.mean(axis=0)).max() < 1e-15
    for stone in (by_mass, by_mean):
        height = stone.vertices @ stone.planes[:, :3].T - stone.planes[:, 3]
        assert abs(height.max(axis=0)).max() < 1e-14


def test_a_large_ball_loads_in_seconds() -> None:
    """81 920 triangles, every one a facet: 3.2 s of processor time measured with 0.9 of it in the hull."""
    ball = trimesh.creation.icosphere(subdivisions=6)
    data = exported(ball, "ply")
    start = time.process_time()
    stone = shape_from_mesh(data, "ply")
    assert time.process_time() - start < 60
    assert stone.convex
    assert len(stone.planes) == 81_920
    assert stone.mass.volume == pytest.approx(4 * np.pi / 3, rel=1e-3)
