"""What decides that a surface is convex: each of three tests catches what the others let through."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from culet.geometry.convexity import DENT, Dent, Polyhedron, convex_form
from culet.geometry.facets import FLATNESS, bend, facets_of, neighbours
from culet.geometry.mass import solid_integrals
from culet.geometry.surface import Triangles
from geometry.shapes import Points, cube, fans


def decided(corners: Points, triangles: Triangles) -> Polyhedron | Dent:
    return convex_form(corners, triangles, solid_integrals(corners, triangles).volume)


def steepest(corners: Points, triangles: Triangles) -> float:
    return float(bend(corners, neighbours(triangles)[1]).max())


def test_a_fine_wide_dimple_hides_from_its_edges_but_not_from_the_hull() -> None:
    ball = trimesh.creation.icosphere(subdivisions=6)
    corners, triangles = np.array(ball.vertices), np.array(ball.faces, np.int64)
    corners *= (1 - 0.06 * np.exp(-2 * (1 - corners[:, 1]) / 0.09))[:, None]
    assert 0 < steepest(corners, triangles) < DENT  # measured 7.2e-5
    form = decided(corners, triangles)
    assert isinstance(form, Dent)
    assert form.depth > DENT


def test_one_wrong_diagonal_is_a_dent_although_every_vertex_is_on_the_hull() -> None:
    """A cube with one corner pulled in: the quad beside it folds along one diagonal outward, along the other inward."""
    corners, faces = cube()
    corners[7] *= 0.9
    triangles = fans(faces)
    outward = [tuple(t) for t in triangles.tolist()]
    for quad in faces:
        if 7 in quad:
            k = quad.index(7)
            a, b, c, d = (quad[(k + n) % 4] for n in range(4))
            outward = [t for t in outward if not set(t) <= set(quad)] + [(b, c, d), (a, b, d)]
    assert isinstance(decided(corners, np.array(outward, np.int64)), Polyhedron)
    inward = [t for t in outward if not set(t) <= set(faces[1])]
    k = faces[1].index(7)
    a, b, c, d = (faces[1][(k + n) % 4] for n in range(4))
    form = decided(corners, np.array([*inward, (a, b, c), (a, c, d)], np.int64))
    assert isinstance(form, Dent)


def test_the_bend_of_two_triangles_is_the_least_height_of_their_tetrahedron() -> None:
    """A unit right corner seen from inside and outside: the least height of that tetrahedron is 1 / sqrt 3."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float64)
    hinge = np.array([(0, 1, 2, 3)])
    assert abs(bend(corners, hinge)[0]) == np.float64(1 / np.sqrt(3)).round(16)
    assert bend(corners, hinge)[0] == -bend(corners, hinge[:, [0, 1, 3, 2]])[0]


def test_facets_that_bend_little_by_little_are_not_taken_for_one() -> None:
    """A strip of 4000 quads rolled into a cylinder: every pair is flat to FLATNESS, the whole is not."""
    n = 4000
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(angle), np.zeros(n), -np.sin(angle)])
    corners = np.vstack([ring, ring + np.array([0, 0.001, 0])])
    quads = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    triangles = fans(quads)
    assert abs(bend(corners, neighbours(triangles)[1])).max() < 5 * FLATNESS
    tolerance = 5 * FLATNESS
    facet = facets_of(corners, triangles, tolerance)
    assert 100 < facet.max() < n  # measured 1000
    for k in range(0, int(facet.max()), 97):
        own = corners[np.unique(triangles[facet == k])]
        assert np.linalg.svd(own - own.mean(axis=0))[1][2] / np.sqrt(len(own)) < tolerance


def test_a_pentagram_double_pyramid_is_not_convex_although_each_edge_is() -> None:
    """Ten triangles that wind twice about the axis: only the volume tells."""
    angle = 2 * np.pi * np.arange(5) / 5
    ring = np.column_stack([np.cos(angle), np.zeros(5), -np.sin(angle)])
    corners = np.vstack([ring, [(0, 1, 0), (0, -1, 0)]])
    sides = [(k, (k + 2) % 5) for k in range(5)]
    triangles = np.array([(a, b, 5) for a, b in sides] + [(b, a, 6) for a, b in sides], np.int64)
    assert steepest(corners, triangles) < 0
    assert isinstance(decided(corners, triangles), Dent)


def test_a_dent_too_small_for_the_volume_is_seen_by_its_edge() -> None:
    """A box whose top has four corners around its middle, two higher: the ridge joins those, or else it is a valley."""
    h = 0.02
    box = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    top = [(h, 1.02, 0), (-h, 1.02, 0), (0, 1.0195, h), (0, 1.0195, -h)]
    corners = np.array([*box, *top], np.float64)
    mesh = trimesh.Trimesh(corners, ConvexHull(corners).simplices, process=False)
    mesh.fix_normals()
    ridge = np.array(mesh.faces, np.int64)
    assert isinstance(decided(corners, ridge), Polyhedron)
    valley = np.array([t for t in ridge.tolist() if not {8, 9} <= set(t)] + [(8, 11, 10), (9, 10, 11)], np.int64)
    form = decided(corners, valley)
    assert isinstance(form, Dent)
    assert form.depth == pytest.approx(1e-3, rel=1e-3)  # measured 9.997e-4


def test_a_sliver_belongs_to_the_facet_around_it_whichever_way_it_points() -> None:
    """Rounding put a corner 1e-9 beyond the side that it lay on: the sliver there faces down, all else up."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0.5, 1e-9, 0), (0.5, 1, 0), (0.5, -1, 0)])
    triangles = np.array([(0, 1, 3), (1, 0, 2), (0, 4, 2), (4, 1, 2)], np.int64)
    assert facets_of(corners, triangles, FLATNESS).tolist() == [0, 0, 0, 0]


def test_the_planes_of_merged_facets_hold_every_vertex() -> None:
    """A globe of 1600 quads in single precision: 5e-8 of noise tilts each plane, and climbing finds what it cuts."""
    globe = trimesh.creation.uv_sphere(count=[40, 40])
    corners = np.array(globe.vertices).astype(np.float32).astype(np.float64)
    form = decided(corners, np.array(globe.faces, np.int64))
    assert isinstance(form, Polyhedron)
    assert len(form.planes) < len(form.triangles)
    highest = (corners @ form.planes[:, :3].T).max(axis=0)
    assert abs(highest - form.planes[:, 3]).max() < 1e-14  # measured 2e-16
